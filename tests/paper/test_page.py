"""The whole page: every section, every anchor that is linked to, and no word that needs a network."""

import re

from ikde.paper.page import make_paper_page
from ikde.report.html import render_html
from ikde.report.markdown import render_markdown


def test_the_page_is_whole(results, inputs):
    page = make_paper_page(results, inputs)
    assert [section.title.split(":")[0] for section in page.sections][:4] == [
        *("Formula 23 and Figure 6", "Table 2 and Figure 7", "Table 3", "Table 4"),
    ]
    html, markdown = render_html(page), render_markdown(page)
    linked = set(re.findall(r'href="#([a-z0-9-]+)"', html))
    assert linked <= set(re.findall(r'id="([a-z0-9-]+)"', html))
    assert not re.search(r'(src|href)="(?!#|data:)', html)
    for words in ("Formula 23", "Table 5", "Situation 3", "how this was made", "ikde bench paper --out report/"):
        assert words.lower() in html.lower()
        assert words.lower() in markdown.lower()
