"""A call is plain while machine code is not there, and says what it waited for when it is."""

import numpy as np
import pytest

from ikde.kernels.jit import CLOCKS
from ikde.model.collision_model import CollisionModel
from ikde.solver import way as way_module
from ikde.solver.background import Question
from ikde.solver.way import Way


class TwoWays:
    """A kernel that tells which way it was run, and is compiled in its first call."""

    def __init__(self):
        self.ran, self.compiled_once = [], False

    def bind(self, *block):
        self.block = block
        return self

    def plain(self, *arguments):
        self.ran.append("plain")
        return arguments[1].dtype == np.int64

    def compiled(self, *arguments):
        if not self.compiled_once:
            for clock in tuple(CLOCKS):
                clock.start()
                clock.end()
        self.compiled_once = True
        self.ran.append("compiled")
        return True


@pytest.fixture
def asked(qiao):
    """A way, and what is behind it."""
    kernel = TwoWays()
    return Way(kernel, Question(CollisionModel.of(qiao), "pose")), kernel


CALL = ("block", np.eye(3), 2**62, 1, 0, 16, np.zeros(3))


@pytest.mark.parametrize(("is_plain", "first", "ran"), [(True, 0, "plain"), (False, 5, "plain")])
def test_a_call_is_plain_until_machine_code_is_there_and_to_its_end(asked, substitute, is_plain, first, ran, capsys):
    way, kernel = asked
    substitute(way_module.answers_plainly, lambda answer, question: is_plain)
    assert way.begin(*CALL[:4], first, *CALL[5:])
    assert (kernel.ran, kernel.block, way.machine) == ([ran], ("block",), None)
    assert (way.take_waited_s(), capsys.readouterr().err) == ((0.0, 0.0), "")


def test_what_it_waits_for_is_named_counted_and_told_once(asked, substitute, capsys):
    way, kernel = asked
    substitute(way_module.answers_plainly, lambda answer, question: False)
    assert way.begin(*CALL)
    assert kernel.ran == ["compiled", "compiled"]
    assert way.machine == kernel.compiled
    assert "pose targets of qiao2021, detector improved" in capsys.readouterr().err
    waited_s, compile_s = way.take_waited_s()
    assert waited_s >= compile_s > 0.0
    assert way.take_waited_s() == (0.0, 0.0)


def test_further_attempts_of_the_question_that_waited_are_machine_code(asked, substitute, capsys):
    way, kernel = asked
    substitute(way_module.answers_plainly, lambda answer, question: False)
    assert way.begin(*CALL)
    kernel.ran.clear()
    assert way.begin(*CALL[:4], 16, 400, CALL[6])
    assert kernel.ran == ["compiled"]
    assert capsys.readouterr().err.count("compiling") == 1
