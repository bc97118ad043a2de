"""Text and names as all files take them."""

from typing import Annotated

from pydantic import AfterValidator, Field, StringConstraints
from pydantic_core import PydanticCustomError

from ikde.model.names import MAX_NAME_LENGTH, find_fault

MAX_TEXT_LENGTH = 5000  # characters


def _check(name: str) -> str:
    fault = find_fault(name)
    if fault:
        raise PydanticCustomError("name", "{fault}", {"fault": fault})
    return name


Text = Annotated[str, StringConstraints(min_length=1, max_length=MAX_TEXT_LENGTH)]
Name = Annotated[Text, AfterValidator(_check), Field(max_length=MAX_NAME_LENGTH)]
