"""Compiling takes minutes, so a whole suite begins with it, in a process beside those of the tests.

What a test needs before it is in the cache, the test compiles itself. What still runs at the end is stopped.
"""

import gc
import os
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
STARTED = []


def begin():
    """Start to compile into the cache."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") == "0":
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        command = [sys.executable, "-m", "tests.ahead"]
        STARTED.append(subprocess.Popen(command, cwd=ROOT, start_new_session=True, **quiet))


def stop():
    """Leave no process behind, nor a child of one."""
    while STARTED:
        process = STARTED.pop()
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def compile_kernels():
    """All that tests need of a robot of the paper's size; only slow ones solve near somewhere in machine code."""
    gc.set_threshold(100_000, 50, 50)  # to look for garbage as often as usual took 5% of compiling
    import ikde
    from ikde.solver.warmup import list_stages, warm_up
    from ikde.track.run import list_track_stages

    robot = ikde.load_robot("qiao2021")
    stages = [*list_stages(robot), *list_track_stages(robot)]
    warm_up([stage for stage in stages if ", near " not in stage.name])


if __name__ == "__main__":
    compile_kernels()
