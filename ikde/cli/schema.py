"""`ikde schema`: what ikde's files may hold, for editors."""

from importlib import import_module
from typing import Annotated

import typer

from ikde.cli.candidates import offer
from ikde.cli.output import print_json

MODELS = {
    "batch": ("ikde.batch.spec", "BatchSpec"),
    "track": ("ikde.track.spec", "TrackSpec"),
    "robot": ("ikde.io.robot_file", "RobotFile"),
    "goal": ("ikde.formats.goal_entries", "GoalFile"),
    "world": ("ikde.formats.world_entries", "WorldFile"),
}


def schema(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="|".join(MODELS), show_default=False, autocompletion=offer(*MODELS), help="The kind of file."
        ),
    ] = None,
) -> None:
    """Print the JSON schema of a kind of file: editors complete its keys and explain them.

    Example: ikde schema batch > batch.schema.json
    """
    from ikde.errors import InputError, nearest

    if name not in MODELS:
        close = nearest(name, MODELS) if name else ""
        raise InputError(
            f"expected the kind of file, one of {', '.join(MODELS)}, got {name or 'nothing'}{close}", ("schema",)
        )
    module, model = MODELS[name]
    print_json(
        {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            **getattr(import_module(module), model).model_json_schema(),
        }
    )
