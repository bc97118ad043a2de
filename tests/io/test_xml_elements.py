"""XML from strangers: what is read, and the one line for what is not."""

import pytest

from ikde.errors import FileError
from ikde.io import xml_elements
from ikde.io.xml_elements import XmlFile
from tests.urdf_texts import write


def reject(folder, text, message, line=None):
    path = write(folder, text, "a.xml")
    with pytest.raises(FileError) as caught:
        XmlFile(path)
    assert message in caught.value.message
    place = f"{path}:{line}" if line else str(path)
    assert str(caught.value) == f"{place}: {caught.value.message}"


def test_elements_know_their_attributes_children_and_lines(tmp_path):
    root = XmlFile(write(tmp_path, '<a>\n <b n="1"/>text<!-- no -->\n <c/>\n <b n="2">\n  <d/></b>\n</a>')).root
    assert [child.tag for child in root.children] == ["b", "c", "b"]
    assert [(child.attributes["n"], child.line) for child in root.find_all("b")] == [("1", 2), ("2", 4)]
    assert root.find("b").attributes == {"n": "1"}
    assert root.find("d") is None


@pytest.mark.parametrize(
    "declared",
    [
        '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]>',
        '<!DOCTYPE r [<!ENTITY e SYSTEM "file:///etc/hostname">]>',
        '<!DOCTYPE r SYSTEM "http://example.com/r.dtd">',
        "<!DOCTYPE r>",
    ],
)
def test_a_doctype_is_refused_before_what_it_declares_is_read(tmp_path, declared):
    reject(tmp_path, f'<?xml version="1.0"?>\n{declared}\n<r n="&a;"/>', "a DOCTYPE is not read here", 2)


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("", "no element found", 1),
        ("<a>\n<b>\n</a>", "mismatched tag", 3),
        ("<a/>\n<b/>", "junk after document element", 2),
        ('<a n="1" n="2"/>', "duplicate attribute", 1),
        ("<a>&nbsp;</a>", "undefined entity", 1),
        ("name: yaml", "syntax error", 1),
    ],
)
def test_what_is_no_xml_is_one_line(tmp_path, text, message, line):
    reject(tmp_path, text, f"not XML: {message}", line)


def test_other_encodings_than_utf_8_are_refused_whatever_they_declare(tmp_path):
    path = tmp_path / "a.xml"
    path.write_bytes('<?xml version="1.0" encoding="utf-16"?><a/>'.encode("utf-16"))
    with pytest.raises(FileError, match="not a UTF-8 text file"):
        XmlFile(path)
    reject(tmp_path, "\N{BYTE ORDER MARK}<a>\n</b>", "mismatched tag", 2)


def test_depth_and_number_of_elements_are_limited(tmp_path, monkeypatch):
    levels = xml_elements.MAX_LEVELS
    assert XmlFile(write(tmp_path, "<a>" * levels + "</a>" * levels)).root.tag == "a"
    reject(tmp_path, "<a>" * (levels + 1) + "</a>" * (levels + 1), "nested too deeply; expected at most 100 levels", 1)
    monkeypatch.setattr(xml_elements, "MAX_ELEMENTS", 3)
    reject(tmp_path, "<a><b/><b/>\n<b/></a>", "too many elements; expected at most 3", 2)


def test_a_file_that_is_too_large_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "0.001")
    reject(tmp_path, f"<a>{'x' * 200}</a>", "expected at most 0.0001 MB ($IKDE_MAX_FILE_MB)")


@pytest.mark.parametrize("text", ["nan", "1 2", "one", "", "1_0"])
def test_a_number_is_one_number(tmp_path, text):
    file = XmlFile(write(tmp_path, f'<a>\n<b n="{text}"/></a>'))
    with pytest.raises(FileError, match=r":2 → joint\.j\.n: expected a number, got"):
        file.read_number(file.root.children[0], "n", 0.0, "joint", "j")


def test_numbers_are_finite_and_as_many_as_asked_for(tmp_path):
    file = XmlFile(write(tmp_path, '<a good=" 1 -2.5e-1\n3 " few="1 2" bad="1 inf 2" far="inf"/>'))
    assert file.read_numbers(file.root, "good", (0.0, 0.0, 0.0)) == (1.0, -0.25, 3.0)
    assert file.read_numbers(file.root, "none", (7.0, 8.0)) == (7.0, 8.0)
    assert file.read_number(file.root, "far") == float("inf")
    assert file.read_number(file.root, "none", 4.0) == 4.0
    for key in ("few", "bad"):
        with pytest.raises(FileError, match="expected 3 finite numbers"):
            file.read_numbers(file.root, key, (0.0, 0.0, 0.0))
    with pytest.raises(FileError, match="expected a number, got ''"):
        file.read_number(file.root, "none")


@pytest.mark.parametrize("text", ["<a/>", '<a name=""/>'])
def test_a_name_that_is_missing_or_empty_is_asked_for(tmp_path, text):
    file = XmlFile(write(tmp_path, text))
    with pytest.raises(FileError, match=":1 → joint: expected an attribute 'name' of <a>"):
        file.read_name(file.root, "name", "joint")
