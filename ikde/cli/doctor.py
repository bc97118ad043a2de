"""`ikde doctor`: versions, cores, cache folder, and how long compiling, loading and solving take here."""

from ikde.cli.options import JsonOption
from ikde.cli.output import announce_compile, print_json, print_result, use_color


def doctor(as_json: JsonOption = False) -> None:
    """Say what ikde runs on, and time one solve."""
    from ikde.cli.machine import describe_machine
    from ikde.report.render import make_table, plain, render

    facts = describe_machine(announce_compile)
    if as_json:
        print_json(facts)
        return
    table = make_table("ikde doctor", "")
    for name, value in facts.items():
        table.add_row(name.replace("_", " "), f"{value:.3f}" if isinstance(value, float) else plain(str(value)))
    print_result(render(table, color=use_color(), width=140))
