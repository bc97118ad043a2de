"""Write benchmarks/robots/chain15.yaml: an arm of 15 turning joints with spheres, for which no closed form exists.

python benchmarks/make_chain.py
"""

from pathlib import Path

OUT = Path(__file__).parent / "robots" / "chain15.yaml"
JOINTS = 15
LINK_M = 0.12
COMMENT = "joints, alternately turning and bending, made by benchmarks/make_chain.py: no closed form, much choice."
HEAD = """\
# A chain of {joints} {comment}
name: chain{joints}
title: {joints}-DoF chain
units: {{length: m, angle: deg}}

joints:
"""


def format_chain(joints: int) -> str:
    """The robot file."""
    lines = [HEAD.format(joints=joints, comment=COMMENT)]
    for k in range(joints):
        limit = 170 if k % 2 == 0 else 100
        lines.append(f"  j{k}: {{kind: revolute, lower: -{limit}, upper: {limit}, home: {0 if k % 2 == 0 else 10}}}\n")
    lines.append("\nframes:\n  base: {parent: world, xyz: [0, 0, 0]}\n")
    parent = "base"
    for k in range(joints):
        axis = "[0, 0, 1]" if k % 2 == 0 else "[0, 1, 0]"
        lines.append(f"  l{k}: {{parent: {parent}, xyz: [0, 0, {LINK_M}], joint: j{k}, axis: {axis}}}\n")
        lines.append(f"  e{k}: {{parent: l{k}, xyz: [0, 0, {LINK_M}]}}\n")
        parent = f"l{k}"
    lines.append(f"  tool: {{parent: {parent}, xyz: [0, 0, {LINK_M}]}}\ntool: tool\n\nspheres:\n  chain:\n")
    lines.append("    - {component: B, from: base, radius: 0.08}\n")
    for k in range(joints):
        lines.append(f"    - {{component: L{k}, from: l{k}, to: e{k}, radius: 0.04, count: 3, spacing: even}}\n")
    lines.append(
        "\ndetectors:\n  chain: {spheres: chain, pairs: non_adjacent, safe_distance: 0}\ndefault_detector: chain\n"
    )
    return "".join(lines)


if __name__ == "__main__":
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(format_chain(JOINTS), encoding="utf-8")
