"""Run a batch: part after part into a folder, stopped at any moment, resumed by the same call."""

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

from ikde.batch.cluster import SolveTasks, open_cluster
from ikde.batch.finish import FinishedPart, finish_parts
from ikde.batch.folder import claim_folder, keep_names
from ikde.batch.local import solve_parts
from ikde.batch.options import check_options
from ikde.batch.parts import Part, list_parts, write_parts
from ikde.batch.plan import Batch
from ikde.batch.summary import RunSummary, RunTally
from ikde.batch.task import make_task
from ikde.errors import InputError

Solve = Callable[[Batch, Sequence[Part]], Generator[list[FinishedPart]]]
"""Parts as they are finished, those together that are written together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far a run is."""

    parts_done: int
    parts: int
    solves_done: int
    solves: int
    parts_found: int
    """Parts that were finished before this call."""

    def after(self, part: Part) -> "Progress":
        """One part further."""
        return replace(self, parts_done=self.parts_done + 1, solves_done=self.solves_done + part.rows)


def run_batch(
    batch: Batch,
    out: str | PathLike[str],
    *,
    threads: int | None = None,
    overwrite: bool = False,
    dask: str | None = None,
    workers: int | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> RunSummary:
    """Solve everything that a batch asks for and write it to a folder.

    A run that was stopped is resumed: finished parts stay, and the answers are the same bits as
    those of a run that was never stopped.

    Args:
        batch: what to solve (`load_batch`).
        out: the folder of the run: new, empty, or that of the same batch.
        threads: how many; None for all cores. The answers do not depend on it.
        overwrite: delete the run that is there, if it is one of ours, and start again.
        dask: address of a Dask cluster that does the work, or `"local"` for processes on this machine.
        workers: processes of `dask="local"`; None for one a core.
        progress: called at the start and after every part.

    Returns:
        What came of it, over all parts of the folder.

    Raises:
        InputError: for what is no batch, options that contradict each other, or a cluster that cannot be reached.
        FileError: for a folder that cannot be used, a full disk, or an input that has gone.
    """
    if not isinstance(batch, Batch):
        raise InputError("expected a Batch; ikde.load_batch reads files and mappings")
    check_options(threads, dask, workers)
    folder = Path(out)
    with _open(threads, dask, workers) as solve, claim_folder(folder, batch, overwrite=overwrite):
        parts = list(list_parts([arm.name for arm in batch.arms], batch.solves, batch.chunk))
        tally = RunTally(folder)
        missing = [part for part in parts if not tally.find(part)]
        now, tell = _start(parts, missing), progress or (lambda now: None)
        tell(now)
        with keep_names(folder) as keep, closing(solve(batch, missing)) as answers:
            for finished in answers:
                write_parts(folder, [one.sealed for one in finished])
                keep()
                for one in finished:
                    tally.add(one.tally)
                    now = now.after(one.part)
                    tell(now)
    return tally.summary()


def _start(parts: list[Part], missing: list[Part]) -> Progress:
    found, solves = len(parts) - len(missing), sum(part.rows for part in parts)
    done = solves - sum(part.rows for part in missing)
    return Progress(parts_done=found, parts=len(parts), solves_done=done, solves=solves, parts_found=found)


@contextmanager
def _open(threads: int | None, dask: str | None, workers: int | None) -> Iterator[Solve]:
    """What solves parts, here or on a cluster: reached, or found out of reach, before a folder is made."""
    if dask is None:
        yield lambda batch, parts: solve_parts(batch, parts, threads)
    else:
        with open_cluster(dask, workers) as solve:
            yield lambda batch, parts: _solve_remotely(solve, batch, parts)


def _solve_remotely(solve: SolveTasks, batch: Batch, parts: Sequence[Part]) -> Generator[list[FinishedPart]]:
    recipe = batch.hash
    with closing(solve(make_task(batch, part) for part in parts)) as answers:
        for answer in answers:
            yield finish_parts(batch, answer, [answer.part], recipe)
