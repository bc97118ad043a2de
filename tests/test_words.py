"""Words that a roboticist would stumble over stay out of names, messages, comments and pages; so do those of no field.

Each entry has a better one beside it. What is allowed all the same stands in `ALLOWED`, with its reason.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MADE = {ROOT / "docs" / "paper" / "report.md"}  # by `ikde bench paper`, from sources that are read here
PAGES = [page for page in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")] if page not in MADE]
SOURCES = [path for kind in ("*.py", "*.yaml", "*.html", "*.js") for path in (ROOT / "ikde").rglob(kind)]
PROVED = ROOT / "ikde" / "model" / "generate" / "proofs.py"
WORDS = {
    r"\b(who|nobody|somebody|everybody)\b": "things are which, nothing and each; people are users and callers",
    r"\b(is|are|was|were|be|been|not) told\b(?! apart)|\btold\b(?= [=,])": "reported, given, set; what it holds",
    r"\blook(ed|s|ing)? (at|into)\b": "checked, graded, diagnosed",
    r"\b(heeds?|minds? (no|none|the))\b": "respects, uses, ignores",
    r"\bgone on with\b|\bhow to go on\b": "resumed, to resume",
    r"\bslides?\b(?! along)": "prismatic, or slips",
    r"\b(fences|wish(es|ed)?|agile|strangers?|knobs?)\b": "constraint, preferred, manipulability, random, setting",
    r"\bevenly\b(?! sp(aced|read))": "linearly, equally, in equal parts",
    r"\b(upside down|none of ours|left alone|as weighed)\b": "say what is wrong, or what is done",
    r"\b(MOST|LEAST|FARTHEST|FEWEST|LARGEST)(_[A-Z]+)*\b|\b[A-Z]+_(MOST|LEAST)\b": "MAX_, MIN_",
    r"\bfarthest\w*\b(?= *[:=(\[])|\bfarthest_": "max_distance, largest",
    r"\bturn(ed|ing)?\b(?= = )|\b(measure|make|bound|compute)_turn": "rotation, angle, yaw; a whole turn is fine",
}
ALLOWED = {
    ("README.md", "who"): "people",
    ("ikde/io/mjcf.py", "slide"): "MuJoCo's name of a prismatic joint",
    ("ikde/kernels/least_motion.py", "slides"): "along contacts",
    ("ikde/kernels/turns.py", "turned"): "by whole turns",
    ("ikde/plot/motion.py", "turn"): "the tool's",
    ("ikde/io/xml_elements.py", "strangers"): "people who send files",
    ("docs/design.md", "strangers"): "the same",
    ("ikde/kernels/cache_folder.py", "everybody"): "users of a machine",
    ("docs/security.md", "stranger"): "people who send files",
    ("docs/index.md", "stranger"): "the same",
    ("ikde/model/region.py", "looks"): "a camera does, at a point",
    ("docs/index.md", "look at"): "a camera does, at a point",
    ("CHANGELOG.md", ""): "what was renamed, and from what",
}


def is_allowed(path: Path, word: str) -> bool:
    return any(str(path.relative_to(ROOT)) == page and part in word for page, part in ALLOWED)


def find_words(path: Path, pattern: str) -> list[tuple[str, str]]:
    """(word, line with its number) of a file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    hits = [
        (f"{path.relative_to(ROOT)}:{number}: {line.strip()}", re.search(pattern, line))
        for number, line in enumerate(lines, 1)
    ]
    return [(hit[0], line) for line, hit in hits if hit]


@pytest.mark.parametrize("pattern", WORDS)
def test_words_are_those_of_the_field(pattern):
    found = {path: find_words(path, pattern) for path in [*SOURCES, *PAGES] if path != PROVED}
    assert [line for path, hits in found.items() for word, line in hits if not is_allowed(path, word)] == [], WORDS[
        pattern
    ]


def test_every_exception_is_needed():
    found = {page: [word for pattern in WORDS for word, _ in find_words(ROOT / page, pattern)] for page, _ in ALLOWED}
    assert [(page, part) for page, part in ALLOWED if not any(part in word for word in found[page])] == []
