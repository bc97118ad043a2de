"""Floor 11: the `ikde` command, one subcommand a file. The only place that prints and exits.

Heavy imports (numpy, numba, matplotlib) stand inside the commands, so that `ikde --help` answers at once.
"""
