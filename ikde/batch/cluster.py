"""Parts solved by a Dask cluster: sent out a few at a time, taken back as they come, sent again if a worker dies."""

import logging
import signal
import threading
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import Any

from ikde.batch.options import LOCAL, check_address
from ikde.batch.parts import GO_ON
from ikde.batch.task import Answer, Task, solve_task
from ikde.errors import InputError
from ikde.model.generate.module import describe_kernels
from ikde.solver.search import usable_cores

SolveTasks = Callable[[Iterable[Task]], Generator[Answer]]
SILENT = logging.CRITICAL + 1
DEAF_TO_CTRL_C = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"  # for workers that start later
TASKS_A_THREAD = 3  # in flight: enough that no worker waits, few enough that memory stays flat
MIN_TASKS = 8  # so that a cluster that grows with its work sees some
TRIES = 5  # times the failures that the scheduler allows by itself
PATIENCE = "10s"  # for a scheduler to answer
SETTINGS = {
    "distributed.scheduler.allowed-failures": 10,  # workers that may die of one part; holds for a local cluster
    "distributed.admin.large-graph-warning-threshold": "1 GiB",  # targets travel with their task, on purpose
}


@contextmanager
def open_cluster(address: str, workers: int | None = None) -> Iterator[SolveTasks]:
    """Reach the cluster at `address`, or start a `"local"` one of so many processes; what it gives solves tasks there.

    Answers come in any order.

    Raises:
        InputError: if `distributed` is not installed, the cluster cannot be reached or goes away, or its workers have
            another ikde.
    """
    distributed = _import_distributed()
    with _quiet(), _connect(distributed, address, workers) as client:
        yield lambda tasks: _until_it_goes(_exchange(distributed, client, iter(tasks)))


def solve_remotely(task: Task, kernels: Mapping[str, str]) -> Answer:
    """What a worker does; `kernels` describes those that must have a hand in the answer."""
    ours = describe_kernels()
    if ours["code"] != kernels["code"]:
        raise InputError("the workers have another version of ikde: its answers would differ")
    if ours["kind"] != kernels["kind"]:
        raise InputError(f"the workers run {ours['kind']} kernels, this run {kernels['kind']} ones (IKDE_KERNELS)")
    return solve_task(task, threads=1)


def _import_distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError("Dask is not installed: pip install 'ikde[cluster]'", ("dask",)) from None
    return distributed


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Dask's log of lost workers off the terminal: what matters of it becomes an error."""
    names = [name for name in logging.root.manager.loggerDict if name.split(".")[0] == "distributed"]
    levels = {logger: logger.level for logger in map(logging.getLogger, names)}
    for logger in levels:
        logger.setLevel(SILENT)
    try:
        yield
    finally:
        for logger, level in levels.items():
            logger.setLevel(level)


@contextmanager
def _connect(distributed: Any, address: str, workers: int | None) -> Iterator[Any]:
    """A client of the cluster; a local cluster lives and dies with it."""
    import dask.config

    check_address(address)
    with dask.config.set(SETTINGS), warnings.catch_warnings(), ExitStack() as stack:
        warnings.simplefilter("ignore", distributed.versions.VersionMismatchWarning)
        if address == LOCAL:
            with _deaf_to_ctrl_c():
                address = stack.enter_context(_start_cluster(distributed, workers or usable_cores()))
        try:
            client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
        except OSError as error:
            raise InputError(f"no cluster answers at {address} ({_first_line(error)})", ("dask",)) from None
        yield stack.enter_context(client)


def _start_cluster(distributed: Any, workers: int) -> Any:
    """Processes on this machine, one thread each, for this process alone."""
    return distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        memory_limit=None,
        dashboard_address="127.0.0.1:0",  # any free port: the usual one may be taken
        silence_logs=SILENT,
        preload=DEAF_TO_CTRL_C,
    )


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Processes that start inside never hear of Ctrl-C, which is meant for this one; nor does it, for these seconds."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _until_it_goes(answers: Generator[Answer]) -> Generator[Answer]:
    """Answers for as long as the cluster is there; raises `InputError` when it is not."""
    try:
        yield from answers
    except (OSError, CancelledError) as error:  # a lost connection shows as one or the other
        why = _first_line(error) or type(error).__name__
        raise InputError(f"the cluster has gone away; {GO_ON} ({why})", ("dask",)) from None


def _exchange(distributed: Any, client: Any, tasks: Iterator[Task]) -> Generator[Answer]:
    """Keep the cluster busy with a bounded number of tasks and give back answers as they come."""
    flying: dict[Any, tuple[Task, int]] = {}
    landed = distributed.as_completed(loop=client.loop)

    def send(task: Task, tries: int) -> None:
        future = client.submit(solve_remotely, task, describe_kernels(), pure=False)
        flying[future] = (task, tries)
        landed.add(future)

    def fill() -> None:
        for task in islice(tasks, max(0, _capacity(client) - len(flying))):
            send(task, 1)

    fill()
    for future in landed:
        task, tries = flying.pop(future)
        if future.status == "error" and isinstance(future.exception(), distributed.KilledWorker) and tries < TRIES:
            send(task, tries + 1)
            continue
        yield _take(distributed, future, task)
        fill()


def _capacity(client: Any) -> int:
    """Tasks that may be in flight now: workers come and go."""
    return max(MIN_TASKS, TASKS_A_THREAD * sum(client.nthreads().values()))


def _take(distributed: Any, future: Any, task: Task) -> Answer:
    """The answer of a future that is done; raises `InputError` for what is the cluster's fault."""
    try:
        return future.result()
    except distributed.KilledWorker:
        message = f"workers keep dying of part {task.part.number} of arm {task.part.arm}; have they enough memory?"
        raise InputError(f"{message} ({GO_ON})", ("dask",)) from None
    except ModuleNotFoundError as error:
        raise InputError(f"the workers need the same packages as this machine ({error})", ("dask",)) from None


def _first_line(error: Exception) -> str:
    return str(error).split("\n")[0]
