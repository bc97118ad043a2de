"""`ikde analyze`."""

import ikde


def test_json_is_what_python_gives(cli, qiao):
    outcome = cli("analyze", "--q", "q2=20", "--angles", "deg", "--by", "actuators", "--radian", "0.3", "--json")
    assert outcome.code == 0
    data, q = outcome.data, qiao.home.copy()
    q[4] = data["q"]["q2"]
    found = ikde.analyze(qiao, q, by="actuators", length_m=0.3)
    assert data["scaled"]["whole"]["pose"]["manipulability"] == float(found.scaled["whole"]["pose"].manipulability)
    assert (data["by"], data["length_m"], data["columns"][0]) == ("actuators", 0.3, "wheel_left")
    assert set(data["raw"]) == {"whole", "arm", "base"}


def test_text_and_a_picture(cli, tmp_path):
    picture = tmp_path / "ellipsoids.png"
    outcome = cli("analyze", "--robot", "panda", "--plot", picture)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("robot panda, tool flange")
    assert outcome.out.endswith(f"wrote {picture}\n")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_what_is_wrong_is_one_line(refuse, tmp_path):
    assert "by: expected one of joints, twist, actuators, got 'wheels'" in refuse("analyze", "--by", "wheels")
    assert "radian: expected a number above 0" in refuse("analyze", "--radian", "0")
    picture = tmp_path / "ellipsoids.xyz"
    refuse("analyze", "--plot", picture)
    assert not picture.exists()
