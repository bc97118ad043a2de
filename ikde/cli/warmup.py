"""`ikde warmup`: compile everything now, so that no later command has to."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ikde.cli.candidates import DEFAULT_ROBOT
from ikde.cli.options import DetectorOption, JsonOption, RobotOption
from ikde.cli.output import is_live, layout, note_console, print_json, print_note, print_result
from ikde.cli.robot_choice import ToolOption, read_robot

if TYPE_CHECKING:
    from ikde.solver.warmup import Stage


def warmup(
    robot: RobotOption = DEFAULT_ROBOT,
    tool: ToolOption = None,
    detector: DetectorOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compile the kernels of a robot ahead: all engines and kinds of target, and tracks; seconds if that is done.

    Example: ikde warmup --robot ur5
    """
    from ikde.report.render import make_table, plain, render
    from ikde.solver.warmup import list_stages, warm_up
    from ikde.track.run import list_track_stages

    model = read_robot(robot, tool)
    stages = [*list_stages(model, detector), *list_track_stages(model, detector)]
    with _progress(len(stages)) as tell:
        done = warm_up(stages, tell)
    if as_json:
        print_json({"robot": model.name, "stages": [{"name": s.name, "compile_seconds": s.seconds} for s in done]})
        return
    table = make_table("kernels", ">compiled in")
    for stage in done:
        table.add_row(plain(stage.name), f"{stage.seconds:.1f} s" if stage.seconds else "was ready")
    table.add_row("together", f"{sum(stage.seconds for stage in done):.1f} s")
    print_result(render(table, **layout()))


@contextmanager
def _progress(count: int) -> Iterator[Callable[[int, "Stage"], None]]:
    """A bar in a terminal, else a line a stage."""
    if not is_live(sys.stderr):
        yield lambda number, stage: print_note(f"{number + 1} of {count}: {stage.name}")
        return
    from rich.progress import Progress

    with Progress(console=note_console()) as bars:
        bar = bars.add_task("compiling", total=count)
        yield lambda number, stage: bars.update(bar, completed=number, description=f"compiling {stage.name}")
        bars.update(bar, completed=count, description="compiled")
