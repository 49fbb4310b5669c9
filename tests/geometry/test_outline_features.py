"""Outlines of pieces: the curves that they are, how they join, what repeats, and what they enclose."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import cos, pi, sin, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.assembly.contact_kinds import shape_kind
from modelgen.errors import SceneError
from modelgen.geometry.mass_properties import mass_properties
from modelgen.geometry.shape_features import features_of
from modelgen.scene import python_scenes as make
from modelgen.scene.expression import evaluate
from modelgen.scene.outline_piece_kinds import Arc, Involute, Line, Piece, formulas_of, numbers_of, rotated
from modelgen.scene.scene_types import Shape

Written = Sequence[Mapping[str, object]]

lengths = st.floats(0.1, 2.0)
angles = st.floats(-4.0, 4.0)
PIECES = st.one_of(
    st.builds(Line, angles, angles, st.floats(5, 6), angles),
    st.builds(Arc, angles, angles, lengths, angles, st.floats(4.5, 6.0)),
    st.builds(Involute, lengths, angles, st.floats(0.1, 1.0), st.floats(1.1, 3.0)),
    st.builds(Involute, lengths, angles, st.floats(-3.0, -1.1), st.floats(-1.0, -0.1)),
)


def gear_teeth(teeth: int, module: float, alpha: float = pi / 9, low: float = 0.2) -> list[dict[str, object]]:
    """One tooth of an involute gear and the gap after it; the root ends where the involute starts."""
    base = module * teeth / 2 * cos(alpha)
    half = pi / (2 * teeth) + tan(alpha) - alpha
    high = float(np.sqrt(((module * (teeth / 2 + 1)) / base) ** 2 - 1))
    return [
        {"kind": "involute", "name": "right", "radius": base, "start": -half, "rolls": [low, high]},
        {"kind": "arc", "name": "tip"},
        {"kind": "involute", "name": "left", "radius": base, "start": half, "rolls": [-high, -low]},
        {"kind": "arc", "name": "root"},
    ]


STADIUM: Written = (
    {"kind": "line", "from": [-0.1, -0.05], "to": [0.1, -0.05]},
    {"kind": "arc", "center": [0.1, 0.0]},
    {"kind": "line", "from": [0.1, 0.05], "to": [-0.1, 0.05]},
    {"kind": "arc", "center": [-0.1, 0.0]},
)


@given(PIECES, st.floats(0.0, 1.0))
def test_a_piece_is_what_its_formula_says_and_moves_by_its_velocity(piece: Piece, t: float) -> None:
    numbers = dict(numbers_of(piece))
    found = [evaluate(each, {**numbers, "t": t}) for each in formulas_of(piece)]
    assert found == pytest.approx(piece.point(t), abs=1e-14 * 20)
    step = 1e-5
    ahead, behind = np.array(piece.point(t + step)), np.array(piece.point(t - step))
    assert (ahead - behind) / (2 * step) == pytest.approx(np.array(piece.velocity(t)), abs=1e-6)


@given(PIECES, angles, st.floats(0.0, 1.0))
def test_a_turned_piece_has_turned_points(piece: Piece, angle: float, t: float) -> None:
    assert piece.turned(angle).point(t) == pytest.approx(rotated(piece.point(t), angle), abs=1e-12)
    assert piece.scaled(3.0).point(t) == pytest.approx(tuple(3.0 * x for x in piece.point(t)), abs=1e-12)


@given(lengths, angles, st.floats(0.2, 3.0), st.sampled_from((-1.0, 1.0)))
def test_the_normals_of_an_involute_touch_its_base_circle(
    radius: float, start: float, roll: float, sign: float
) -> None:
    """At the point where the string leaves the circle, radius |roll| from the curve."""
    piece = Involute(radius, start, sign * roll, sign * (roll + 1.0))
    leaves = radius * np.array([cos(start + sign * roll), sin(start + sign * roll)])
    string = np.array(piece.point(0.0)) - leaves
    assert np.linalg.norm(string) == pytest.approx(radius * roll, rel=1e-12)
    assert string @ leaves == pytest.approx(0.0, abs=1e-12)
    assert string @ np.array(piece.velocity(0.0)) == pytest.approx(0.0, abs=1e-12)


def test_repeated_teeth_are_one_kind_for_each_piece_whatever_the_gear() -> None:
    gears = [make.outline_wall(gear_teeth(n, 0.01), 0.02, repeat=n) for n in (12, 18)]
    faces = [feature for gear in gears for feature in features_of(gear).features if feature.dimension == 2]
    assert len(faces) == 4 * 30
    assert len({shape_kind(face.shape, fold=False) for face in faces}) == 2  # involutes and arcs
    assert {face.shape.pose.is_identity for face in faces} == {True}


def test_a_gear_has_its_corners_where_flanks_meet_the_tips() -> None:
    names = Counter(
        feature.name.rsplit("_", 1)[0]
        for feature in features_of(make.outline(gear_teeth(12, 0.01), repeat=12)).features
    )
    assert names == dict.fromkeys(("right", "tip", "left", "root", "corner_tip", "corner_left"), 12)
    walls = Counter(
        feature.dimension
        for feature in features_of(make.outline_wall(gear_teeth(12, 0.01), 0.02, repeat=12)).features
    )
    assert walls == {2: 48, 1: 24}


def nexts(shape: Shape) -> dict[str, list[str | None]]:
    return {
        feature.name: [each.next for each in feature.conditions if each.kind == "parameter"][:2]
        for feature in features_of(shape).features
        if feature.dimension == 2
    }


def test_pieces_that_meet_without_an_angle_lead_to_each_other() -> None:
    assert nexts(make.outline_wall(STADIUM, 0.1)) == {
        "side0": ["side3_part1", "side1_part0"], "side1_part0": ["side0", "side1_part1"],
        "side1_part1": ["side1_part0", "side2"], "side2": ["side1_part1", "side3_part0"],
        "side3_part0": ["side2", "side3_part1"], "side3_part1": ["side3_part0", "side0"],
    }  # fmt: skip


def test_nothing_follows_at_a_concave_corner() -> None:
    root = nexts(make.outline_wall(gear_teeth(12, 0.01), 0.02, repeat=12))["root_0"]
    assert root == [None, None]


def test_walls_have_the_moments_of_the_prisms_that_they_bound() -> None:
    corners = [[0.0, 0.0], [0.3, 0.0], [0.4, 0.2], [0.1, 0.3]]
    lines = [{"kind": "line", "from": corner} for corner in corners]
    wall, solid = make.outline_wall(lines, 0.2), make.extrusion(0.2, points=corners)
    for found, expected in zip(mass_properties(wall, 5.0), mass_properties(solid, 5.0), strict=True):
        assert np.abs(found - expected).max() < 1e-14
    disc = make.outline_wall([{"kind": "arc", "radius": 0.1, "angles": [0, "2*pi"]}], 0.2)
    for found, expected in zip(
        mass_properties(disc, 5.0), mass_properties(make.cylinder(0.1, 0.2), 5.0), strict=True
    ):
        assert np.abs(found - expected).max() < 1e-14
    mass, centre, _ = mass_properties(make.outline_wall(STADIUM, 0.1), 1.0)
    assert mass == pytest.approx(0.1 * (0.2 * 0.1 + pi * 0.05**2), rel=1e-13)
    assert np.abs(centre).max() < 1e-15


def test_the_area_of_a_gear_is_that_of_a_fine_polygon() -> None:
    gear = make.outline_wall(gear_teeth(18, 0.01), 1.0, repeat=18)
    assert gear.outline is not None
    x, y = np.array([s.piece.point(t) for s in gear.outline for t in np.arange(2000) / 2000]).T
    area = (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    assert mass_properties(gear, 1.0)[0] == pytest.approx(area, rel=1e-7)


@pytest.mark.parametrize(
    ("pieces", "keys", "found"),
    [
        ([], {}, "an outline without pieces"),
        ([{"kind": "line"}, {"kind": "line"}], {}, r"pieces\[0\].*whose start is not known"),
        ([*STADIUM[:3], {"kind": "arc", "center": [-0.1, 0.01]}], {}, "an arc of radius 0.04"),
        ([{"kind": "arc", "radius": 0.1, "angles": [0, 3]}], {}, "a piece that ends .* the first one"),
        ([{"kind": "arc", "radius": 0.1, "angles": ["2*pi", 0]}], {}, "turns|clockwise"),
        ([{**STADIUM[0], "name": "a"}, STADIUM[1], {**STADIUM[2], "name": "a"}, STADIUM[3]], {}, "named 'a'"),
        (gear_teeth(12, 0.01), {"repeat": 40}, "times about itself"),
        ([{"kind": "involute", "radius": 1, "start": 0, "rolls": [-0.1, 1]}], {}, "it has a cusp"),
    ],
)
def test_pieces_that_are_no_outline_are_refused(pieces: Written, keys: dict[str, int], found: str) -> None:
    with pytest.raises(SceneError, match=found):
        make.outline(pieces, **keys)
