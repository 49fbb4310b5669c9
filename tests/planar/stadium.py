"""A prism over a stadium: two straight sides joined smoothly by half circles, written as a `solid`."""

from __future__ import annotations

from math import pi

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape

STRAIGHT, RADIUS, HALF = 0.03, 0.02, 0.05  # half a straight side, radius of the ends, half the height; m

Part = dict[str, object]


def quadric(next: str, c: float, *first: float, round: float = 0.0) -> Part:
    """c + first . x - round (x^2 + y^2) >= 0."""
    numbers = [c, *first, *(0.0,) * (3 - len(first)), -round, -round, 0.0, 0.0, 0.0, 0.0]
    return {"kind": "quadric", "numbers": numbers, "next": next}


def part(name: str, shape: Part, *conditions: Part) -> Part:
    return {"name": name, "shape": shape, "conditions": list(conditions)}


def wing(next: str, *numbers: float) -> Part:
    return {"kind": "wing", "numbers": list(numbers), "next": next}


def until(next: str, sign: float, bound: float) -> Part:
    return {"kind": "parameter", "numbers": [0, sign, bound], "next": next}


def end(name: str, up: int) -> tuple[list[Part], list[Part]]:
    """The top (up = 1) or bottom (-1): a rectangle and two half discs side by side, and what bounds them."""
    plane = {"kind": "plane", "rpy": [0.0 if up > 0 else pi, 0.0, 0.0], "position": [0.0, 0.0, up * HALF]}
    sides = [
        quadric(f"{name}_{'back' if y * up < 0 else 'front'}", RADIUS, 0.0, float(y)) for y in (1, -1)
    ]  # the plane of the bottom has its y axis turned round
    ends = [quadric(f"{name}_{'left' if x > 0 else 'right'}", STRAIGHT, float(x)) for x in (1, -1)]
    faces, edges = [part(name, plane, *ends, *reversed(sides))], []
    across = wing(name, -1.0, 0.0)
    for s, here, near, far in ((1, "right", "front", "back"), (-1, "left", "back", "front")):
        z = {"position": [s * STRAIGHT, 0.0, up * HALF], "rpy": [0.0, 0.0, 0.0 if s > 0 else pi]}
        square = (RADIUS**2 - STRAIGHT**2) / (2 * RADIUS)
        inside = quadric(f"{name}_arc_{here}", square, s * STRAIGHT / RADIUS, round=0.5 / RADIUS)
        faces.append(part(f"{name}_{here}", plane, quadric(name, -STRAIGHT, float(s)), inside))
        edges.append(
            part(
                f"{name}_arc_{here}",
                {"kind": "circle", "radius": RADIUS, **z},
                wing(f"{name}_{here}", -1.0, 0.0),
                wing(f"side_{here}", 0.0, -up),
                until(f"{name}_{near}", 1, -pi / 2),
                until(f"{name}_{far}", -1, pi / 2),
            )
        )
    for s, here, before, after in ((-1, "front", "left", "right"), (1, "back", "right", "left")):
        z = {"position": [0.0, s * RADIUS, up * HALF], "rpy": [0.0, 0.0, 0.0 if s < 0 else pi]}
        ranges = until(f"{name}_arc_{before}", 1, -STRAIGHT), until(f"{name}_arc_{after}", -1, STRAIGHT)
        shape = {"kind": "edge", "length": 2 * STRAIGHT, **z}
        edges.append(part(f"{name}_{here}", shape, across, wing(f"side_{here}", 0.0, -up), *ranges))
    return faces, edges


def sides() -> list[Part]:
    found = []
    for s, here in ((-1, "front"), (1, "back")):
        turn = {"axis": [1.0, 0.0, 0.0], "angle": -s * pi / 2}
        plane = {"kind": "plane", "axis_angle": turn, "position": [0.0, s * RADIUS, 0.0]}
        limits = [
            quadric("side_left", STRAIGHT, 1.0),
            quadric("side_right", STRAIGHT, -1.0),
            quadric(f"bottom_{here}", HALF, 0.0, -float(s)),
            quadric(f"top_{here}", HALF, 0.0, float(s)),
        ]
        found.append(part(f"side_{here}", plane, *limits))
    for s, here in ((1, "right"), (-1, "left")):
        bend = {"kind": "cylinder", "radius": RADIUS, "position": [s * STRAIGHT, 0.0, 0.0]}
        limits = [
            quadric(f"bottom_arc_{here}", HALF, 0.0, 0.0, 1.0),
            quadric(f"top_arc_{here}", HALF, 0.0, 0.0, -1.0),
            quadric("side_front", RADIUS, float(s), 1.0),
            quadric("side_back", RADIUS, float(s), -1.0),
        ]
        found.append(part(f"side_{here}", bend, *limits))
    return found


def stadium() -> Shape:
    faces, edges = sides(), []
    for name, up in (("bottom", -1), ("top", 1)):
        more, rims = end(name, up)
        faces, edges = faces + more, edges + rims
    return make.solid(face=faces, edge=edges, convex=True)
