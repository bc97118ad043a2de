"""`python -m ikde` and the `ikde` command."""

from ikde.cli.app import main

if __name__ == "__main__":
    main()
