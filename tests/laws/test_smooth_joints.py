"""Where surfaces of shapes that are fixed together join smoothly, a body goes on as on one surface."""

from __future__ import annotations

import pytest

from modelgen import derive, emit, require, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.benchmarks.smooth_joints import drawn, fault, run_of
from tests.running import compiled

MEMBERS = {  # ground: number of the member, and what it is
    "fields": 4,  # a capsule, on two bodies
    "charts": 3,  # a ball that slides, on welded bodies
    "splines": 0,  # a ball that rolls, on two bodies
    "turned": 2,  # an ellipsoid, from a cone into a bowl
    "box and chart": 3,  # a ball that rolls from the chart to the box
    "rounded box": 6,  # an ellipsoid that slides from the round edge to the top
    "ramp": 1,  # an ellipsoid that slides up from a floor that is covered from there on
}


@pytest.mark.parametrize("ground", MEMBERS)
def test_bodies_pass_smooth_joints_without_an_event(ground: str) -> None:
    member = drawn(MEMBERS[ground], [ground])
    path = run_of(member)
    assert fault(member, path) == ""
    assert path.is_trusted, path.doubts
    assert "feature-change" in {each.kind for each in path.events}


def ramp(slope: str = "0.3", height: str = "0.0", **terms: float) -> Scene:
    """A ball on a slope that goes over into a rounded top; `terms` of its contact with the slope."""
    top = make.chart("u", "v", f"{slope}*u - 0.2*u**2", domain=[(0.0, 1.0), (-0.5, 0.5)], name="top")
    slope_ = make.chart("u", "v", f"0.3*u + {height}", domain=[(-1.0, 0.0), (-0.5, 0.5)], name="slope")
    ball = make.dynamic("ball", make.sphere(0.1), density=1000.0, position=[-0.5, 0.0, 0.3])
    contacts = [{"between": ["ball", "ground/top"]}, {"between": ["ball", "ground/slope"], **terms}]
    return make.scene("ramp", [make.fixed("ground", top, slope_), ball], contact=contacts)


def test_contacts_go_over_in_both_directions() -> None:
    handovers = require(ramp()).handovers
    assert {(each.feature_pair, each.next) for each in handovers} == {(0, 1), (1, 0)}


@pytest.mark.parametrize("scene", [ramp(slope="0.300001"), ramp(height="1e-6"), ramp(friction=0.2)])
def test_kinks_steps_and_contacts_on_other_terms_are_no_smooth_joints(scene: Scene) -> None:
    assert require(scene).handovers == ()


def slab(other: Shape) -> Scene:
    """A ball on a slab that ends at x = 0, with another shape fixed to it."""
    box = make.box(1.0, 1.0, 0.2, position=[-0.5, 0.0, 0.0], name="box")
    ball = make.dynamic(
        "ball", make.sphere(0.1), density=1000.0, position=[-0.1, 0.0, 0.2], velocity=[1, 0, 0]
    )
    shapes = (box, other)
    contacts = [{"between": ["ball", f"slab/{each.name}"]} for each in shapes]
    return make.scene("slab", [make.fixed("slab", *shapes), ball], contact=contacts)


def test_a_rounded_end_goes_over_into_both_sides_of_a_slab() -> None:
    rod = make.cylinder(0.1, 1.0, rpy=[1.5707963267948966, 0.0, 0.0], name="rod")
    model = require(slab(rod))
    names = [each.features[1] for each in model.feature_pairs]
    found = {(names[each.feature_pair], names[each.next]) for each in model.handovers}
    assert found >= {("top", "side"), ("bottom", "side"), ("side", "top"), ("side", "bottom")}


def test_a_ball_rolls_over_the_seam_of_two_level_boxes() -> None:
    scene = slab(make.box(1.0, 1.0, 0.3, position=[0.5, 0.0, -0.05], name="other"))
    path = simulate(compiled(emit(derive(require(scene)))), until=0.2, samples=2)
    assert path.is_trusted, path.doubts
    assert [each.kind for each in path.events] == ["feature-change"]
    assert abs(path.v[-1, -1] - [1.0, 0.0, 0.0]).max() < 1e-12


@pytest.mark.parametrize(("ground", "handovers"), [(make.plane(), 0), (make.sphere(1.0), 2)])
def test_a_round_edge_is_kept_where_a_plane_is_touched_along_a_line_beyond(
    ground: Shape, handovers: int
) -> None:
    pin = make.cylinder(0.1, 0.4, name="pin")
    head = make.dome(0.1, 0.1, name="head", position=[0.0, 0.0, 0.2])
    moving = make.dynamic("peg", pin, head, density=1000.0, position=[0.0, 0.0, 2.0])
    contacts = [{"between": ["ground", f"peg/{each.name}"]} for each in (pin, head)]
    model = require(make.scene("peg", [make.fixed("ground", ground), moving], contact=contacts))
    assert len(model.handovers) == handovers
    assert bool(model.joined) == bool(handovers)
