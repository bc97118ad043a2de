"""Names that would do something if they were taken for more than names, and robots that bear them."""

from dataclasses import replace
from types import MappingProxyType

import yaml

from ikde.model.robot import WORLD

PRINTABLE = {
    "backslash": "\\{}\\",
    "100 letters": "{:関<100}",
    "quotes": """{}'''; "" " '""",
    "shell": "{} $(touch ran); `touch ran` | touch ran",
    "path": "../../{}/../..",
    "markup": "[bold red]{}[/] <script>alert(1)</script> & -->",
    "formula": "=cmd|'/c calc'!{}",
    "yaml": "{}: [&a *a] # !!python/object",
    "blank": "  {}  ",
    "dash": "--{}",
}
"""Templates of names that are allowed; each holds the name that was there, so that all stay different."""
HIDDEN = tuple("\n\r\t\x00\x1b\x7f\x85\xa0\u200b\u2028\u202e\u2066\ufeff")
"""What no name may hold."""

INTERPRETED = (
    "[red]",
    "[/]",
    "[link=https://x.example]here[/link]",
    "a[bold",
    "]b",
    "ends in \\",
    "ends in \\\\",
    ":warning:",
    "<script>alert(1)</script>",
    "</script><svg onload=alert(1)>",
    "\"' onmouseover='x",
    "{{ 7 * 7 }} {% raw %}",
    "$x^2$ $\\frac{",
    "**b** _i_ `c` [l](javascript:x) ![i](http://x.example/y.png)",
    "https://x.example www.x.example",
    "# a heading | - a list",
    "&lt;b&gt; &#0;",
    '"""\\nimport os',
    "手臂" * 20,
    "=HYPERLINK(1)",
)
"""What rich, a browser, Markdown, matplotlib, Jinja or a spreadsheet would take for more than text."""
ORDERS = (
    "\x1b[31mred\x1b[0m",
    "\x1b]0;title\x07",
    "\x9b2J",
    "a\r\nikde: all is well",
    "a\tb",
    "\u202etfel",
    "a\u2028b",
    "\x00",
)
"""What a terminal would obey, or what turns and breaks lines: in titles and in names of targets."""
EVERYTHING = (*INTERPRETED, *ORDERS)


def rename_in_file(text, new, names):
    """The text of a YAML file with `new(name)` for all of `names`, as keys and as values."""

    def walk(data):
        if isinstance(data, dict):
            return {walk(key): walk(value) for key, value in data.items()}
        if isinstance(data, list):
            return [walk(item) for item in data]
        return new(data) if data in names else data

    return yaml.safe_dump(walk(yaml.safe_load(text)), sort_keys=False)


def payload(marker, line="; "):
    """A name that ends the docstring that it is put into and makes a file."""
    return f'x"""{line}open({str(marker)!r}, "w"){line}"""'


def rename(robot, new):
    """The robot with `new(name)` for every name in it, as Python can make it, without any check."""

    def old(name):
        return name if name in (WORLD, None, "none", "non_adjacent") else new(name)

    def pairs(every):
        return tuple((old(a), old(b)) for a, b in every)

    rows = {
        old(name): tuple(
            replace(row, component=old(row.component), start=old(row.start), end=old(row.end)) for row in each
        )
        for name, each in robot.approximations.items()
    }
    detectors = {
        old(name): replace(each, name=old(name), spheres=old(each.spheres), pairs=old(each.pairs))
        for name, each in robot.detectors.items()
    }
    return replace(
        robot,
        name=old(robot.name),
        title=old(robot.title),
        joints=tuple(replace(joint, name=old(joint.name)) for joint in robot.joints),
        frames=tuple(
            replace(frame, name=old(frame.name), parent=old(frame.parent), joint=old(frame.joint))
            for frame in robot.frames
        ),
        tool=old(robot.tool),
        approximations=MappingProxyType(rows),
        pair_lists=MappingProxyType({old(name): pairs(each) for name, each in robot.pair_lists.items()}),
        detectors=MappingProxyType(detectors),
        default_detector=old(robot.default_detector),
    )
