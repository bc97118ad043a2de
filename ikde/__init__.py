"""Collision-aware inverse kinematics for mobile manipulators.

Names are imported when they are first used, so `import ikde` costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "load_robot": "ikde.io.robots",
    "robot_names": "ikde.io.robots",
    "Robot": "ikde.model.robot",
    "Detector": "ikde.model.robot",
    "Target": "ikde.model.target",
    "SolveSettings": "ikde.solver.settings",
    "SolveResult": "ikde.solver.result",
    "StopReason": "ikde.solver.result",
    "solve": "ikde.solver.solve",
    "solve_many": "ikde.solver.solve",
    "solve_distinct": "ikde.solver.solve",
    "forward": "ikde.solver.forward",
    "check": "ikde.solver.check",
    "CheckResult": "ikde.solver.check",
    "verify": "ikde.solver.verify",
    "Verification": "ikde.solver.verify",
    "from_convention": "ikde.model.convention",
    "to_convention": "ikde.model.convention",
    "IkdeError": "ikde.errors",
    "InputError": "ikde.errors",
    "FileError": "ikde.errors",
    "VerificationError": "ikde.errors",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'ikde' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
