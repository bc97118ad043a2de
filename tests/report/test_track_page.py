"""The page of a track: self-contained, with its figures and the robot moving."""

import re
from types import SimpleNamespace

import pytest

import ikde
from ikde.report.html import render_html
from ikde.report.markdown import render_markdown
from ikde.report.track_page import list_near, make_track_page, tell_obstacles
from ikde.track.follow_path import grade_motion
from ikde.track.plan import TrackPlan
from ikde.track.summary import summarise_track
from ikde.track.trajectory import Followed, TrackStop, TrackStopReason
from tests.track.measured import make_measured, make_still
from tests.track.worlds import OBSTACLES, make_among

MAX_BYTES = 5_000_000
STOP = TrackStop(sample=21, reason=TrackStopReason.SPEED_LIMIT, text="sample 21: q2 would need 3 rad/s")


def make_page(motion):
    return make_track_page(motion, "wave <1>", "ikde track 'my path.yaml' --out FOLDER")


@pytest.fixture(scope="module")
def page(qiao):
    return make_page(make_measured(qiao, further=5, stop=STOP))


@pytest.fixture(scope="module")
def text(page):
    return render_html(page)


@pytest.fixture(scope="module")
def unchecked(qiao):
    """The page of a motion without a detector."""
    return make_page(make_measured(qiao, detector="none"))


@pytest.fixture(scope="module")
def alone(qiao):
    """The page of a start, of which nothing was followed."""
    return make_page(make_measured(qiao, steps=0, further=5))


def test_the_page_needs_nothing_else(text):
    assert len(text) < MAX_BYTES
    assert re.findall(r'(?:src|href)="(?!#|data:image/png)', text) == []
    assert re.findall(r"@import|@font-face|url\((?!#)|https?://(?!www.w3.org)", text) == []
    assert "wave &lt;1&gt;" in text


def test_it_shows_everything(page, text):
    assert [section.title for section in page.sections] == [
        *("Motion", "Clearance and limits", "Figures", "Path and error", "Joints", "Base", "How it was made"),
    ]
    assert text.count("<svg") == 6
    assert text.count("<canvas") == 1
    assert text.count("data:image/png") == 1
    assert "drawView" in text
    assert "Animation in the HTML page" in render_markdown(page)


def test_a_stop_is_not_overlooked(text):
    assert "The path was not followed to its end" in text
    assert STOP.text in text


def test_a_robot_that_stands_still_has_a_fixed_base():
    page = make_page(make_still(ikde.load_robot("ur5")))
    assert "Base" not in [section.title for section in page.sections]
    assert "the tool's axis given, fixed base, method continuation" in page.subtitle
    assert ("base", "fixed base") in page.sections[-1].blocks[0].items
    text = render_html(page)
    assert "Where the tool was asked to go and went.<" in text
    assert not any(word in text for word in ("omnidirectional", "differential", "drove", "platform"))


def test_without_a_detector_the_page_says_not_checked(unchecked):
    numbers = {item.label: item.value for item in unchecked.lead[-1].items}
    assert numbers["self-collision"] == "not checked"
    assert unchecked.lead[-1].items[3].note == "of all other kinds, at all samples"
    assert not any("clearance" in label for label in numbers)
    text = render_html(unchecked)
    assert "What collides is black" not in text
    assert text.count("Self-collision was not checked.") == 2
    assert "certified" not in text


def test_the_caption_of_the_margins_says_certified_where_something_is(page, alone, unchecked):
    def caption(page):
        return next(section for section in page.sections if section.title == "Clearance and limits").blocks[0].caption

    assert caption(page).startswith("The smallest clearance of any pair, at the samples and certified between them. ")
    assert caption(alone).startswith("The smallest clearance of any pair, at the samples. ")
    assert caption(unchecked).startswith("The least share of a joint's range")


def test_it_says_what_measured(page):
    figures = next(section for section in page.sections if section.title == "Figures")
    assert figures.blocks[0].caption == "Measured by plain numpy, not by the kernels that search"
    assert "differential drive" in page.subtitle


def make_empty(motion):
    """The same, but not even its start was met."""
    was = motion.trajectory
    nothing = Followed(q=was.q[:0], stop=was.stop, seconds=was.seconds[:0], search_seconds=0.25)
    plan = TrackPlan.of(motion.robot, was.path, limits=was.limits, collision=motion.collision)
    return summarise_track(motion.collision, grade_motion(plan, nothing))


def test_nothing_followed_is_a_short_page(qiao):
    stop = TrackStop(sample=0, reason=TrackStopReason.OUT_OF_REACH, text="sample 0: out of reach")
    motion = make_measured(qiao, stop=stop)
    nothing = make_empty(motion)
    page = make_page(nothing)
    assert [section.title for section in page.sections] == ["How it was made"]
    assert "Nothing was followed" in render_html(page)


def test_a_start_alone_is_shown(alone):
    assert "Motion" in [section.title for section in alone.sections]
    assert "smallest clearance at samples" in [item.label for item in alone.lead[-1].items]
    assert "certified" not in render_html(alone)  # there is nothing between


def test_it_says_how_it_was_made(page):
    code = page.sections[-1].blocks[-1]
    assert (code.text, code.caption) == ("ikde track 'my path.yaml' --out FOLDER", "The same again")


def test_in_a_world_it_says_which_and_what_comes_nearest(qiao):
    motion = make_among(qiao, 0.01, margins_m={"LT": 0.0})
    page = make_page(motion)
    clearance = next(section for section in page.sections if section.title == "Clearance and limits")
    table = clearance.blocks[-1]
    assert [row[0] for row in table.rows] == ["post", *[row[0] for row in table.rows][1:]]
    assert {row[0] for row in table.rows} == set(OBSTACLES)
    seen = [ikde.check(qiao, q, motion.collision) for q in motion.trajectory.q]
    for name, component, gap, asked, when in table.rows:
        rows = [row for one in seen for row in one.obstacles if row.obstacle == name]
        best = min(rows, key=lambda row: row.clearance_m - row.margin_m)
        assert (component, gap) == (best.component, f"{1e3 * best.clearance_m:.2f}")
        assert asked == f"{1e3 * best.margin_m:.2f}"
        sample = int(when.rpartition(" ")[2])
        assert best in seen[sample].obstacles
        assert when.startswith(f"{0.02 * sample:.2f} s")
    facts = dict(page.sections[-1].blocks[0].items)
    assert motion.collision.world.digest[:12] in facts["world"]
    assert facts["margin"].count("10 mm") == 1
    number = page.lead[-1].items[2]
    assert number.label == "least to spare at samples"
    assert number.note.startswith(f"{motion.closest_pair[0]} and {motion.closest_pair[1]}; ")
    text = render_html(page)
    assert text.count("Obstacles are grey, violet where anything is too near; the green ring is where") == 2
    assert "to any obstacle, at the samples and certified" in text


def test_of_many_obstacles_it_says_how_many_are_drawn_and_listed(qiao):
    balls = {f"b{k}": {"sphere": {"radius": 0.01}, "position": [0.1 * k - 5, 1.5, 1.0]} for k in range(100)}
    motion = make_among(qiao, obstacles=balls)
    assert "The 60 nearest of 100 obstacles are grey" in tell_obstacles(motion)
    table = list_near(motion)
    assert table.note.endswith(" Of 100 obstacles.")
    assert len(table.rows) == 12


def test_what_has_least_to_spare_is_said_with_what_it_was_asked_for(qiao):
    """Of a margin that only what is asked for makes decisive."""
    motion = make_among(qiao, 0.06)
    number = make_page(motion).lead[-1].items[2]
    assert motion.closest_pair[1] in OBSTACLES
    apart_mm = 1e3 * motion.grade.clearance_m
    assert number.note.startswith(f"{' and '.join(motion.closest_pair)} {apart_mm:.3g} mm apart, 60 mm asked for; ")
    assert number.value == f"{apart_mm - 60.0:.3g} mm"


def test_what_the_robot_holds_is_named_with_its_colour():
    things = (SimpleNamespace(name="can"), SimpleNamespace(name="lid"))
    held = SimpleNamespace(obstacles=(), world=SimpleNamespace(attached=things))
    motion = SimpleNamespace(collision=held, closest_obstacle=None, trajectory=SimpleNamespace(moving={}))
    assert tell_obstacles(motion) == " What the robot holds is brown: can, lid."
    held.obstacles = ("shelf",)
    assert tell_obstacles(motion).endswith(" where anything is too near. What the robot holds is brown: can, lid.")
