"""Whether a question waits for machine code: the first are answered in plain Python while a child process compiles.

`$IKDE_COMPILE` may say `wait` (compile when it is needed, as all kernels but these do), or `never` (numba is not even
imported: everything is a hundred times as slow). The child is one a process and one a cache folder, has the lowest
priority and ends with its parent; what it compiles comes to its parent by the cache folder alone.
"""

import atexit
import json
import os
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from typing import Any, NamedTuple, Protocol

from ikde.errors import InputError, quoted
from ikde.kernels import cache_folder
from ikde.kernels.jit import COMPILE
from ikde.model.collision_model import CollisionModel
from ikde.model.plain_data import encode
from ikde.solver.compile_note import name_work
from ikde.solver.compile_turn import is_taken_for, mark_work

BACKGROUND, WAIT, NEVER = WAYS = ("background", "wait", "never")
LATER = "later"
"""Plain Python until that has failed, and no child: for a process of one answer, which ends before it were compiled."""
UNLESS_TOLD: ContextVar[str] = ContextVar("way", default=BACKGROUND)
ONE, NEAR, MANY = "one", "near", "many of"
GRACE_S = 0.5
TRIES = 2
"""How often a child is started for a question whose child is killed."""
START = "import json, sys; q = json.loads(sys.stdin.readline()); sys.path[:] = q['path']; "
START += "from ikde.solver.compiler_process import run; run(q)"


@contextmanager
def compile_way(way: str) -> Iterator[None]:
    """What is done inside the block, on this thread, unless `$IKDE_COMPILE` says `wait` or `never`."""
    token = UNLESS_TOLD.set(way)
    try:
        yield
    finally:
        UNLESS_TOLD.reset(token)


def choose_way() -> str:
    """One of `WAYS`, or `LATER`; raises `InputError` for another word in `$IKDE_COMPILE`."""
    given = os.environ.get(COMPILE) or BACKGROUND
    if given not in WAYS:
        raise InputError(f"expected {', '.join(WAYS)}, got {quoted(given)}", (f"${COMPILE}",))
    return UNLESS_TOLD.get() if given == BACKGROUND else given


class Question(NamedTuple):
    """What machine code answers: targets of a kind, one without `near`, one with it, or many, by an engine."""

    collision: CollisionModel
    kind: str
    call: str = ONE
    engine: str = "lm"

    def describe(self) -> str:
        """What is compiled for it, in words."""
        return name_work(f"{self.kind} targets", self.collision)

    def encode(self) -> dict[str, Any]:
        """Plain data for the child."""
        collision, *others = self
        return {"robot": encode(collision.robot), "detector": encode(collision.detector), "what": others}


class Answer(Protocol):
    """What answers a question, as machine code or not."""

    @property
    def is_kept(self) -> bool:
        """True if its machine code lies in the cache."""
        ...


def answers_plainly(answer: Answer, question: Question) -> bool:
    """True while a question is to be answered in plain Python; the child is started if there is something to do."""
    way = choose_way()
    if way in (NEVER, LATER):
        return True
    if way == WAIT or not _can_start():
        return False
    return CHILD.works_on(question) or (not answer.is_kept and CHILD.compile(question))


def _can_start() -> bool:
    """A child needs a cache to put its work into, and a Python to run: in a frozen program that is the program."""
    return cache_folder.CACHE_IS_WRITABLE and bool(sys.executable) and not getattr(sys, "frozen", False)


class Child:
    """The process that compiles, if there is one."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._tries: Counter[Question] = Counter()
        self._killed: set[Question] = set()
        self._question: Question | None = None

    @property
    def is_at_work(self) -> bool:
        """True while it runs."""
        return self._process is not None and self._process.poll() is None

    def works_on(self, question: Question) -> bool:
        """True while it runs for this: what it compiles it may be writing still."""
        return question == self._question and self.is_at_work

    def compile(self, question: Question) -> bool:
        """True if it is at work, or has been started for this, or another process is about it; else False.

        If it has ended without, it is not tried again, but once if it was killed. What is asked while it works on
        something else is compiled when that is done, if it is still asked then.
        """
        with self._lock:
            if self.is_at_work:
                return True
            if self._question and self._process and self._process.poll():
                self._killed.add(self._question)
            tries = TRIES if question in self._killed else 1
            if self._tries[question] >= tries:
                return is_taken_for(cache_folder.CACHE_FOLDER, mark_work(question.encode()))
            self._tries[question] += 1
            self._question = question
            with suppress(OSError):
                self._process = start(question.encode())
            return self.is_at_work

    def stop(self) -> None:
        """Let it end: it does when its standard input is closed."""
        process = self._process
        if process is None or process.poll() is not None:
            return
        with suppress(OSError):
            process.stdin.close()  # type: ignore[union-attr]
        try:
            process.wait(GRACE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def forget(self) -> None:
        """After a fork: the child belongs to the process that started it, and its standard input stays open there."""
        self.__init__()


def start(question: dict[str, Any]) -> "subprocess.Popen[bytes]":
    """Start a child that finds modules where this process does, and give it its question."""
    flags: dict[str, Any] = {"start_new_session": True}  # Ctrl-C in a terminal is not for it
    if sys.platform == "win32":
        flags = {"creationflags": subprocess.IDLE_PRIORITY_CLASS | subprocess.CREATE_NO_WINDOW}
    environment = {**os.environ, COMPILE: WAIT, "IKDE_CACHE_DIR": str(cache_folder.CACHE_FOLDER.parent)}
    process: Any = subprocess.Popen(
        [sys.executable, "-P", "-c", START],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        **flags,
    )
    request = {**question, "path": sys.path, "parent": os.getpid(), "cache": str(cache_folder.CACHE_FOLDER)}
    process.stdin.write(json.dumps(request).encode() + b"\n")
    process.stdin.flush()
    return process


CHILD = Child()
atexit.register(CHILD.stop)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=CHILD.forget)
