"""House rules that a linter cannot check, read from the source of `ikde/`."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "ikde"
SOURCES = sorted(PACKAGE.rglob("*.py"))
TREES = {path: ast.parse(path.read_text(encoding="utf-8")) for path in SOURCES}
FORBIDDEN_NAMES = {"utils", "util", "types", "core", "base", "helpers", "common", "misc"}
MAX_FILE_LENGTH, MAX_LENGTH, MAX_ARGUMENTS, MOST_HAVE = 350, 80, 11, 4  # 11: three and eight keywords, of `solve`
KERNEL_DECORATORS = {"kernel", "counting_kernel", "leaf_kernel", "inline_kernel", "inline_view_kernel"}
PROVENANCE = {"published", "derived", "calibrated"}
CITATION = re.compile(r"\[([A-Z][A-Za-z]+\d{4}|DongZhao)\b")  # whose copy names no year
NO_TEST_OF_ITS_OWN = {
    "__main__.py": "two lines; tests/cli/test_app.py runs them in a process",
    "cli/exit_codes.py": "an enumeration; tests/cli/test_app.py",
    "cli/startup.py": "tests/cli/conftest.py undoes it, test_app.py starts processes",
    "formats/goal_entries.py": "tests/io/test_goal_file.py reads every entry",
    "formats/world_entries.py": "tests/io/test_world_file.py reads every entry",
    "formats/units.py": "two tables; tests/cli/test_solve.py and tests/report/test_numbers.py use every unit",
    "io/plan_file.py": "tests/io/test_batch_file.py and test_track_file.py load every kind of plan",
    "io/sphere_entries.py": "tests/model/test_free_spheres.py reads every kind of row",
    "io/target.py": "tests/cli/test_solve.py makes every kind of target",
    "io/robots.py": "tests/io/test_robot_file.py and tests/robots",
    "kernels/arrays.py": "tuples, and `read_only`; tests/model/test_pack.py fills them",
    "kernels/servo.py": "tests/track/test_servo.py takes its steps, compiled and not",
    "kernels/servo_parts.py": "parts of kernels/servo.py; tests/track/test_servo.py",
    "kernels/servo_room.py": "tuples and numbers of codes; tests/track/test_servo.py fills them",
    "model/robot.py": "dataclasses; tests/model/test_validate.py and tests/robots",
    "solver/preferred.py": "a dataclass; tests/solver/test_prefer.py",
    "solver/result.py": "a dataclass; tests/solver/test_solve.py",
    "track/servo_result.py": "dataclasses; tests/track/test_servo.py reads all of them",
    "spheres/shapes.py": "a dataclass; tests/io/urdf_import/test_cover_links.py",
}


def inside(path, package):
    return PACKAGE / package in path.parents


def functions(path):
    return [node for node in ast.walk(TREES[path]) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]


def length(function):
    """Lines, signature and docstring included."""
    return function.end_lineno - function.lineno + 1


def arguments(function):
    """How many it takes, `self` aside."""
    given = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    return len(given) - (bool(given) and given[0].arg in ("self", "cls"))


def imported(path):
    """Top-level names of everything that a file imports."""
    for node in ast.walk(TREES[path]):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module.split(".")[0]


def calls(path):
    return {ast.unparse(node.func) for node in ast.walk(TREES[path]) if isinstance(node, ast.Call)}


def is_kernel(function):
    return any(getattr(decorator, "id", None) in KERNEL_DECORATORS for decorator in function.decorator_list)


def has_code(path):
    return any(isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Assign) for node in TREES[path].body)


def citations(path):
    return set(CITATION.findall(path.read_text(encoding="utf-8")))


def offences(rule, files=SOURCES):
    """File -> what a rule has against it; nothing if all keep it."""
    found = {str(path.relative_to(PACKAGE)): rule(path) for path in files}
    return {name: offence for name, offence in found.items() if offence}


def test_a_file_says_in_its_name_what_it_holds():
    assert offences(lambda path: path.stem in FORBIDDEN_NAMES) == {}


def test_a_file_is_short():
    assert offences(lambda path: len(path.read_text(encoding="utf-8").splitlines()) > MAX_FILE_LENGTH) == {}


def test_a_function_is_short():
    def measure(path):
        return {f.name: length(f) for f in functions(path) if length(f) > MAX_LENGTH}

    assert offences(measure) == {}


def test_a_function_takes_few_arguments():
    """Kernels and commands aside: what a kernel needs stands in its signature, and an option is one of a command's."""
    others = [path for path in SOURCES if not (inside(path, "kernels") or inside(path, "cli"))]
    counts = sorted(arguments(f) for path in others for f in functions(path) if not is_kernel(f))
    assert (counts[-1], counts[int(0.9 * len(counts))]) <= (MAX_ARGUMENTS, MOST_HAVE)
    assert counts[int(0.9 * len(counts))] <= MOST_HAVE


def test_a_file_opens_with_what_it_is_for():
    assert offences(lambda path: not ast.get_docstring(TREES[path])) == {}


def test_only_the_command_line_prints():
    """But for one line: what is compiled, where somebody waits for it."""
    loud = {"print", "sys.stdout.write", "sys.stderr.write", "sys.exit"}
    found = offences(lambda path: not inside(path, "cli") and loud & calls(path))
    assert found == {"solver/compile_note.py": {"sys.stderr.write"}}


def test_arithmetic_is_strict():
    def is_fast(path):
        keywords = {node.arg for node in ast.walk(TREES[path]) if isinstance(node, ast.keyword)}
        texts = {node.value for node in ast.walk(TREES[path]) if isinstance(node, ast.Constant)}
        return "fastmath" in keywords | texts

    assert offences(is_fast) == {}


def test_only_kernels_know_numba():
    assert offences(lambda path: not inside(path, "kernels") and "numba" in set(imported(path))) == {}


def test_a_kernel_is_known_by_its_decorator():
    files = [path for path in SOURCES if inside(path, "kernels") and path.name != "jit.py"]
    used = {ast.unparse(mark) for path in files for f in functions(path) for mark in f.decorator_list}
    assert {name for name in used if "kernel" in name} == KERNEL_DECORATORS


def test_a_kernel_says_what_it_computes():
    assert offences(lambda path: [f.name for f in functions(path) if is_kernel(f) and not ast.get_docstring(f)]) == {}


def test_a_kernel_never_raises():
    def raises(kernel):
        return any(isinstance(node, ast.Raise | ast.Try) for node in ast.walk(kernel))

    assert offences(lambda path: [f.name for f in functions(path) if is_kernel(f) and raises(f)]) == {}


def test_a_module_with_code_has_a_test_file_of_its_name():
    def is_wrong(path):
        test = ROOT / "tests" / path.relative_to(PACKAGE).parent / f"test_{path.name}"
        return test.exists() == (str(path.relative_to(PACKAGE)) in NO_TEST_OF_ITS_OWN)  # missing, or no exception more

    assert offences(is_wrong, [path for path in SOURCES if path.name != "__init__.py" and has_code(path)]) == {}


def test_every_exception_is_a_file():
    assert [name for name in NO_TEST_OF_ITS_OWN if not (PACKAGE / name).exists()] == []


def test_every_citation_has_its_reference():
    table = (ROOT / "docs" / "references.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\| \[(\w+)\]", table, flags=re.MULTILINE))
    texts = [*SOURCES, *PACKAGE.rglob("*.yaml"), *(ROOT / "docs").glob("*.md"), ROOT / "README.md"]
    cited = {key for path in texts for key in citations(path)}
    assert cited - listed == set()
    assert listed - cited == set()


def test_provenance_has_three_words():
    kinds = set()
    for path in (PACKAGE / "robots").glob("*.yaml"):
        kinds |= set(re.findall(r"\{kind: (\w+),\s+text:", path.read_text(encoding="utf-8")))
    assert kinds == PROVENANCE


def test_the_tests_mirror_the_package():
    folders = {path.parent.relative_to(PACKAGE) for path in SOURCES if has_code(path)}
    assert [str(folder) for folder in folders if not (ROOT / "tests" / folder).is_dir()] == []


def test_no_test_file_imports_from_another():
    def borrows(path):
        names = []
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import | ast.ImportFrom):
                names += [f"{getattr(node, 'module', '')}.{alias.name}" for alias in node.names]
        return [name for name in names if ".test_" in name]

    borrowed = {path.name: borrows(path) for path in (ROOT / "tests").rglob("*.py")}
    assert {name: found for name, found in borrowed.items() if found} == {}
