"""`ikde robots spheres`: links covered anew or from a file, a page, or one line and nothing written."""

import ikde
from ikde.io.urdf_import.refit import list_link_spheres
from tests.urdf_texts import change, write

BOXY = change('<sphere radius="0.05"/>', '<box size="0.1 0.1 0.4"/>')


def make(cli, folder):
    path, out = write(folder, BOXY), folder / "arm.yaml"
    assert cli("robots", "import", path, "-o", out).code == 0
    return path, out


def count(path):
    return {link: len(own) for link, own in list_link_spheres(ikde.load_robot(path)).items()}


def test_one_link_is_covered_anew_and_its_note_with_it(cli, tmp_path):
    path, out = make(cli, tmp_path)
    before, page = count(out), tmp_path / "page.html"
    asked = ("--urdf", path, "--link", "upper", "--protrusion", "8")
    outcome = cli("robots", "spheres", out, *asked, "-o", out, "--report", page)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("robot ")
    assert outcome.out.endswith(f"wrote {out}\nwrote {page}\n")
    assert "1 box" in outcome.out
    after = count(out)
    assert after["upper"] > before["upper"]
    assert after | {"upper": before["upper"]} == before
    notes = [line for line in out.read_text().splitlines() if line.startswith("# spheres of upper")]
    assert len(notes) == 1
    assert f"upper: {after['upper']} for 1 box" in notes[0]
    html = page.read_text()
    assert html.count("data:image/png;base64,") == 3
    assert "ikde robots spheres" in html


def test_spheres_are_taken_from_a_file_of_all_links_or_of_one(cli, tmp_path):
    _, out = make(cli, tmp_path)
    ball = "[{center: [0, 0, 0.3], radius: 0.03}]"
    given = write(tmp_path, f"collision_spheres: {{upper: {ball}, fore: {ball}}}", "curobo.yml")
    outcome = cli("robots", "spheres", out, "--spheres", given, "--link", "fore", "-o", tmp_path / "b.yaml", "--json")
    assert [own["link"] for own in outcome.data["spheres"]] == ["fore"]
    assert list_link_spheres(ikde.load_robot(tmp_path / "b.yaml"))["fore"].tolist() == [[0.0, 0.0, 0.3, 0.03]]
    both = cli("robots", "spheres", out, "--spheres", given, "--json")
    assert [own["link"] for own in both.data["spheres"]] == ["upper", "fore"]
    assert both.err == "ikde: the robot is not written without -o FILE\n"


def test_a_page_of_a_urdf_needs_nothing_else(cli, tmp_path):
    path, page = write(tmp_path, BOXY), tmp_path / "page.html"
    outcome = cli("robots", "spheres", path, "--report", page, "--json")
    known = {own["link"]: (own["covered"], own["how"]) for own in outcome.data["spheres"]}
    assert known["upper"] == (1.0, "as in the robot's file")
    assert known["fore"] == (None, "as in the robot's file")
    assert page.exists()


def test_what_is_wrong_is_one_line_and_nothing_is_written(cli, refuse, tmp_path):
    path, out = make(cli, tmp_path)
    text, new = out.read_text(), tmp_path / "new.yaml"
    given = write(tmp_path, "collision_spheres: {upper: [{center: [0, 0, 0], radius: 1}]}", "curobo.yml")
    for asked, message in (
        ((out,), "expected --link NAME, --spheres FILE or --report FILE.html, got none"),
        ((out, "--link", "upper"), "urdf: expected --urdf FILE: a robot file has spheres"),
        ((out, "--urdf", path, "--link", "uper"), "no link is called 'uper' (did you mean 'upper'?)"),
        ((out, "--urdf", path, "--link", "tip"), "has no collision shapes to cover"),
        ((out, "--urdf", path, "--report", tmp_path / "page.pdf"), "expected a file with the ending .html"),
        ((out, "--urdf", path, "--link", "upper", "--protrusion", "-1"), "protrusion_m: expected a number above 0"),
        ((out, "--spheres", given, "--link", "fore"), "curobo.yml has no spheres for 'fore'"),
        ((out, "--spheres", tmp_path / "none.yml"), "no such file"),
        ((out, "--urdf", "nothing", "--link", "upper"), "nothing"),
    ):
        assert message in refuse("robots", "spheres", *asked, "-o", new)
    before = path.read_text()
    assert "is what is read" in refuse("robots", "spheres", out, "--urdf", path, "--link", "upper", "-o", path)
    assert path.read_text() == before
    assert out.read_text() == text
    assert not new.exists()
    assert not list(tmp_path.glob("page.*"))
