"""What a DAE shows is counted, so that nothing of it can be missing; what would be is refused."""

from xml.etree import ElementTree

import pytest

from ikde.spheres.collada import MAX_INSTANCES, count_triangles

VERTEX = '<input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/>'
TRIANGLES = f"<triangles>{VERTEX}<p>0 0 1 0 2 0 0 0 2 0 3 0</p></triangles>"
ACCESSOR = '<accessor source="#a" stride="3"><param name="X"/><param name="Y"/><param name="Z"/></accessor>'
TWICE = '<instance_node url="#n{0}"/><instance_node url="#n{0}"/>'
SHOW = '<node><instance_geometry url="#g"/></node>'


def count(primitives=TRIANGLES, nodes=SHOW, accessor=ACCESSOR, library=""):
    mesh = f'<source id="p">{accessor}</source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
    geometry = f'<geometry id="g"><mesh>{mesh}{primitives}</mesh><extra/></geometry><geometry id="b"><brep/></geometry>'
    scene = f'<visual_scene id="s">{nodes}</visual_scene><scene><instance_visual_scene url="#s"/></scene>'
    return count_triangles(ElementTree.fromstring(f'<COLLADA xmlns="urn:x">{geometry}{library}{scene}</COLLADA>'))


@pytest.mark.parametrize(
    ("primitives", "found"),
    [
        (TRIANGLES, 2),
        (f"<polylist>{VERTEX}<vcount>3 4 2</vcount><p>0 0</p></polylist>", 3),
        (f"<polygons>{VERTEX}<p>0 0 1 0 2 0</p><p>0 0 1 0 2 0 3 0 4 0</p></polygons>", 4),
        (f"<tristrips>{VERTEX}<p>0 0 1 0 2 0 3 0</p></tristrips>{TRIANGLES}", 4),
        (f"<trifans>{VERTEX}<p>0 0 1 0 2 0 3 0</p></trifans>", 2),
        (f"<lines>{VERTEX}<p>0 0 1 0</p></lines>{TRIANGLES}", 2),
        ("", 0),
    ],
)
def test_triangles_of_all_kinds_are_counted(primitives, found):
    assert count(primitives) == found


def test_each_instance_counts():
    library = f'<library_nodes><node id="n">{SHOW}</node></library_nodes>'
    assert count(nodes=f'{SHOW}<node><node><instance_node url="#n"/></node>{SHOW}</node>', library=library) == 6
    assert count(nodes="") == 0
    assert count(nodes=f"{SHOW}<node><lookat>0</lookat></node>") == 2  # as of a camera


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"nodes": '<node><instance_geometry url="#x"/></node>'}, "no geometry is called '#x' in it"),
        ({"nodes": '<node><instance_geometry url="other.dae#g"/></node>'}, "no geometry is called"),
        ({"nodes": '<node><instance_geometry url="#b"/></node>'}, "the geometry '#b' is no mesh"),
        ({"nodes": '<node><instance_controller url="#c"/></node>'}, "a skin or a morph"),
        ({"nodes": f"<node><skew>0</skew>{SHOW}</node>"}, "a place by skew or lookat is not read"),
        ({"nodes": '<node id="o"><instance_node url="#o"/></node>'}, "nested too deeply"),
        ({"nodes": SHOW * (MAX_INSTANCES + 1)}, "it shows too much; expected at most 5,000 nodes"),
        ({"primitives": f"<polygons>{VERTEX}<ph/></polygons>"}, "polygons with holes"),
        ({"primitives": TRIANGLES.replace("3 0", "-1 0")}, "expected indices of at least 0"),
        ({"primitives": TRIANGLES.replace('"1"', '"x"')}, "expected a number, got 'x'"),
        ({"accessor": ACCESSOR.replace('"3"', '"4"')}, "expected corners as X, Y and Z"),
        ({"accessor": ACCESSOR.replace('stride="3"', 'stride="3" offset="3"')}, "expected corners as X, Y and Z"),
        ({"accessor": ACCESSOR.replace('"X"', '"Z"')}, "expected corners as X, Y and Z"),
    ],
)
def test_what_would_be_missing_is_refused(changed, message):
    with pytest.raises(ValueError, match=message):
        count(**changed)


def test_nodes_that_multiply_are_refused_at_once():
    names = "".join(f'<node id="n{k}">{TWICE.format(k + 1)}</node>' for k in range(40))
    library = f'<library_nodes>{names}<node id="n40">{SHOW}</node></library_nodes>'
    with pytest.raises(ValueError, match="it shows too much"):
        count(nodes='<node><instance_node url="#n0"/></node>', library=library)
