"""What the papers print ships with ikde."""

from ikde.paper.inputs import load_misprints, load_published


def test_every_table_of_the_paper_is_there():
    published = load_published()
    assert {"formula_23", "table_2", "table_3", "table_4", "table_5", "situations"} <= set(published)
    assert [len(published["table_3"]["rows_s"]), len(published["table_5"])] == [10, 10]
    assert load_published() is published


def test_every_misprint_says_where_what_and_why():
    for entry in load_misprints():
        assert set(entry) == {"paper", "kind", "place", "printed", "meant", "evidence"}
        assert entry["kind"] in ("misprint", "puzzle")
