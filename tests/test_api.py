"""The names that users import: they exist, are documented, are known to type checkers, and cost nothing to look at."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import ikde

SOURCE = ast.parse(Path(ikde.__file__).read_text(encoding="utf-8"))
FUNCTIONS = sorted(name for name in ikde._HOME if inspect.isfunction(getattr(ikde, name)))
every_name = pytest.mark.parametrize("name", sorted(ikde._HOME))


def names_for_type_checkers():
    """Name -> module of the imports under `if TYPE_CHECKING`."""
    block = next(node for node in SOURCE.body if isinstance(node, ast.If))
    assert block.test.id == "TYPE_CHECKING"
    return {alias.asname: node.module for node in block.body for alias in node.names if alias.asname == alias.name}


@every_name
def test_a_name_comes_from_its_home(name):
    assert getattr(ikde, name).__module__ == ikde._HOME[name]


@every_name
def test_a_name_is_listed_and_documented(name):
    assert name in dir(ikde)
    assert inspect.getdoc(getattr(ikde, name))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_call_stays_small(name):
    kinds = [parameter.kind for parameter in inspect.signature(getattr(ikde, name)).parameters.values()]
    assert kinds.count(inspect.Parameter.KEYWORD_ONLY) <= 8


def test_type_checkers_see_the_same_names():
    assert names_for_type_checkers() == ikde._HOME


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'ikde' has no attribute 'sovle'"):
        _ = ikde.sovle


def test_importing_ikde_imports_nothing_heavy():
    script = "import ikde, sys; dir(ikde); print(sorted({'numpy', 'numba', 'scipy', 'yaml'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_says_what_it_takes(name):
    function = getattr(ikde, name)
    text = inspect.getdoc(function)
    parameters = inspect.signature(function).parameters
    shared = "rguments as for `solve`" in " ".join(text.split())
    if not parameters:
        return
    assert "Args:" in text or shared or all(f"`{parameter}`" in text for parameter in parameters)
    if "Args:" in text:
        section = text.split("Args:")[1]
        assert [parameter for parameter in parameters if f"    {parameter}: " not in section] == []


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_is_typed(name):
    signature = inspect.signature(getattr(ikde, name))
    assert signature.return_annotation is not inspect.Signature.empty
    assert all(p.annotation is not inspect.Parameter.empty for p in signature.parameters.values())
