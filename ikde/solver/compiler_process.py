"""The process behind `solver/background.py`: compiles what one question needs into the cache, and ends.

Its parent sends it, on standard input, a robot as plain data: no code, no pickle, no name of a file but that of
the cache folder. Nothing is imported before it may compile, so that those which wait take no room.
"""

import os
import sys
import threading
import time
from pathlib import Path
from typing import Any

from ikde.solver.compile_turn import mark_work, take_turn

POLL_S = 0.5


def run(question: dict[str, Any]) -> None:
    """Wait for the lock, compile, end; at the lowest priority."""
    if hasattr(os, "nice"):
        os.nice(19)
    threading.Thread(target=_end_with, args=(question["parent"],), daemon=True).start()
    threading.Thread(target=_end_with_input, daemon=True).start()
    with take_turn(Path(question["cache"]), mark_work(question)):
        compile_answer(question)


def compile_answer(question: dict[str, Any]) -> None:
    """Compile what answers one question."""
    from ikde.model.collision_model import CollisionModel
    from ikde.model.plain_data import decode
    from ikde.model.robot import NO_DETECTOR, Detector, Robot
    from ikde.solver.warmup import list_stages, warm_up

    detector = decode(Detector | None, question["detector"])
    collision = CollisionModel.of(decode(Robot, question["robot"]), detector or NO_DETECTOR)
    kind, call, engine = question["what"]
    wanted = f"{engine}, {call} {kind}"
    warm_up([stage for stage in list_stages(collision.robot, collision) if stage.name == wanted])


def _end_with(parent: int) -> None:
    """End when the parent has: another process may have inherited the other end of standard input."""
    while os.getppid() == parent:
        time.sleep(POLL_S)
    leave()


def _end_with_input() -> None:
    """End when the parent closes standard input, which its own end does."""
    sys.stdin.read()
    leave()


def leave() -> None:
    """End at once, but for a file of the cache that is being written."""
    writing = sys.modules.get("ikde.kernels.cache_files")
    if writing is not None:
        writing.WRITING.acquire()
    os._exit(1)
