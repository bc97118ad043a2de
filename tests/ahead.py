"""What takes minutes is begun when a session starts, in processes of its own: most tests keep one core busy.

Types are checked; `test_tooling.py` waits for the verdict. Kernels are compiled into the cache, for a whole suite only;
what a test needs before it is there, the test compiles itself. What still runs at the end of the session is stopped.
"""

import os
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
TYPES = [str(Path(sys.executable).parent / "pyright"), "--pythonpath", sys.executable]
KERNELS = [sys.executable, "-m", "tests.ahead"]
WHOLE = 1000  # tests; fewer are no whole suite
STARTED = {}


def begin(tests):
    """Start what these tests need."""
    if any(name.endswith("test_types_hold") for name in tests):
        STARTED["types"] = _start(TYPES, subprocess.PIPE)
    if len(tests) >= WHOLE and os.environ.get("NUMBA_DISABLE_JIT", "0") == "0":
        STARTED["kernels"] = _start(KERNELS, subprocess.DEVNULL)


def check_types():
    """(exit code, output) of the type checker."""
    process = STARTED["types"]
    output, _ = process.communicate()
    return process.returncode, output


def stop():
    """Leave no process behind, nor a child of one."""
    while STARTED:
        _, process = STARTED.popitem()
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        if process.stdout:
            process.stdout.close()


def _start(command, output):
    own = {"stdin": subprocess.DEVNULL, "start_new_session": True}
    return subprocess.Popen(command, cwd=ROOT, stdout=output, stderr=subprocess.STDOUT, text=True, **own)


def compile_kernels():
    """Last what the first tests compile meanwhile: then it is in the cache."""
    import ikde
    from ikde.solver.warmup import list_stages, warm_up
    from ikde.track.warmup import list_track_stages

    robot = ikde.load_robot("qiao2021")
    stages = {stage.name: stage for stage in list_stages(robot)}
    late = [stages.pop(name) for name in ("memetic", "analytic")]
    warm_up([*late, *list_track_stages(robot), *stages.values()])


if __name__ == "__main__":
    compile_kernels()
