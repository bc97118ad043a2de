"""From a solved part to what is written of it and counted: its two files as bytes, and its tally."""

from collections.abc import Sequence
from dataclasses import dataclass

from ikde.batch.parts import Part, SealedPart, seal_part
from ikde.batch.plan import Batch
from ikde.batch.tally import Counting, PartTally
from ikde.batch.task import Answer, cut_answer


@dataclass(frozen=True, slots=True)
class FinishedPart:
    """A part that only has to be written."""

    sealed: SealedPart
    tally: PartTally

    @property
    def part(self) -> Part:
        """Which."""
        return self.sealed.part


def finish_parts(batch: Batch, answer: Answer, parts: Sequence[Part], recipe: str) -> list[FinishedPart]:
    """The parts that were solved as one, each as if it had been solved by itself; `recipe` is the batch's hash."""
    counting = Counting.of([grader.name for grader in batch.graders], batch.repeats, batch.source.count)
    return [_finish(counting, one, recipe) for one in cut_answer(answer, parts)]


def _finish(counting: Counting, answer: Answer, recipe: str) -> FinishedPart:
    sealed = seal_part(answer.part, answer.solutions, answer.timing, recipe=recipe)
    tally = counting.count(answer.part, answer.solutions, answer.timing["solve_seconds"].to_numpy())
    return FinishedPart(sealed, tally)
