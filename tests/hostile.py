"""Names that robots, targets and files may have, and that no terminal and no browser may obey."""

NAMES = (
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
EVERYTHING = (*NAMES, *ORDERS)
