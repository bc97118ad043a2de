"""The detection section: six lists, their differences, surface points against centres, and times."""

from ikde.paper.detection_page import show_detection
from ikde.report.page import Cell, Table, Text


def test_every_list_rule_and_grid_has_its_row(results, inputs):
    data = results.sections["detection"]
    section = show_detection(data, inputs)
    lists, differences, surface, times = [block for block in section.blocks if isinstance(block, Table)]
    assert len(lists.rows) == 6
    assert [row[2] for row in lists.rows] == ["35", "33", "33"] * 2
    assert differences.rows[0][2:4] == ("(L2, J5)", "(G, L1), (G, L2), (G, LT)")
    assert len(surface.rows) == len(data.surface_differs)
    assert [row[0] for row in times.rows] == ["typical", "improved"]


def test_a_home_that_points_call_a_collision_is_marked(results, inputs):
    section = show_detection(results.sections["detection"], inputs)
    surface = [block for block in section.blocks if isinstance(block, Table)][2]
    marked = {(row[0], row[1], row[2]) for row in surface.rows if isinstance(row[3], Cell)}
    assert ("typical", "eq. 20", "36 × 18") in marked
    assert ("improved", "eq. 20", "360 × 180") not in marked


def test_the_text_counts_what_eq_18_sees(results, inputs):
    data = results.sections["detection"]
    blind = [row for row in data.surface_differs if row.rule == "eq. 18"]
    text = next(block for block in show_detection(data, inputs).blocks if isinstance(block, Text)).markup
    assert f"sees 0 of {sum(row.centres_collide for row in blind)} collisions" in text


def test_the_text_counts_verdicts_that_differ_from_the_data(results, inputs):
    data = results.sections["detection"]
    text = next(block for block in show_detection(data, inputs).blocks if isinstance(block, Text)).markup
    for row in data.surface_differs:
        if row.rule == "eq. 20":
            assert f"{row.only_surface_collides:,} ({row.approximation})" in text.split("\n\n")[0]
    for row in data.lists_differ:
        changed = row.only_this_collides + row.only_the_other_collides
        assert f"{changed:,} ({row.approximation})" in text.split("\n\n")[1]
