"""What is left out of a scene saves what `check` says, and changes nothing that is left."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from modelgen import derive, emit, read, require, simulate
from modelgen.codegen.emit import Package
from modelgen.dynamics.planar_motion_proof import in_a_plane
from modelgen.report.savings_by_decision import DECISIONS, savings_of
from modelgen.scene.python_scenes import dynamic, ellipsoid, fixed, plane, scene, sphere
from modelgen.scene.scene_types import Scene
from tests.running import SCENES, library_of


def ball_on_table(**keys: object) -> Scene:
    ball = dynamic("ball", sphere(0.1), mass=1.0, inertia=[4e-3] * 3, position=[0.0, 0.0, 0.1])
    return scene("ball", [fixed("table", plane()), ball], contact=[{"between": ["ball", "table"]}], **keys)


def rhs(what: Scene) -> ca.Function:
    return derive(require(what)).function("mg_rhs")


def counted(package: Package) -> int:
    """Instructions of the kernels that one evaluation calls, from the manifest."""
    manifest, instance = package.manifest, package.manifest.instance
    functions, kinds = manifest.functions, manifest.kinds
    names = [
        f"{kinds['body'][b['kind']]['name']}_{r}"
        for b in instance["bodies"]
        for r in ("pose", "motion", "path")
    ]
    feature_pairs = [instance["feature_pairs"][max(c["feature_pair"], 0)] for c in instance["contacts"]]
    names += [f"{kinds['contact'][feature_pair['kind']]['name']}_rates" for feature_pair in feature_pairs]
    names += [f"{kinds['joint'][joint['kind']]['name']}_rows" for joint in instance["joints"]]
    return sum(functions[f"mg_{name}"]["instructions"] for name in names if f"mg_{name}" in functions)


def test_a_frictionless_ball_on_a_plane_of_which_the_place_is_observed_takes_twenty_instructions() -> None:
    assert rhs(ball_on_table(observe=["ball.position"])).n_instructions() <= 20


def test_each_decision_saves_something_on_a_ball_on_a_plane() -> None:
    saved = {s.decision: s.as_json()["saved"] for s in savings_of(derive(require(ball_on_table())))}
    taken = ("fixed body", "form without eta", "no friction", "no rotation", "no derivatives")
    assert all(saved[decision]["instructions"] > 0 for decision in taken)
    assert all(saved[decision]["bytes"] > 0 for decision in taken[:-1])
    assert saved["no rotation"]["states"] == saved["no friction"]["states"] == 7
    assert saved["form without eta"]["states"] == 3


@pytest.mark.parametrize("name", ["bouncing_ball", "ellipsoid_on_plane", "double_pendulum"])
def test_what_a_decision_saves_is_the_difference_of_two_derivations(name: str) -> None:
    model = require(read(SCENES / f"{name}.toml"))
    for saving in savings_of(derive(model)):
        if saving.decision not in DECISIONS or not saving.taken:
            continue
        undone = DECISIONS[saving.decision](model)
        assert undone is not None
        found = [emit(derive(require(what)).of_kinds()) for what in (model.scene, undone[1])]
        text = [sum(len(each.files[name]) for name in ("kernels.c", "model.c")) for each in found]
        states = [sum(each.manifest.instance[n] for n in ("n_q", "n_u", "n_eta")) for each in found]
        assert saving.as_json()["saved"]["bytes"] == text[1] - text[0]
        assert saving.as_json()["saved"]["states"] == states[1] - states[0]
        assert saving.as_json()["saved"]["instructions"] == counted(found[1]) - counted(found[0])


@pytest.mark.parametrize("decision", ["form without eta", "no rotation"])
def test_a_run_is_the_same_without_a_decision(decision: str) -> None:
    """Rolling off a bowl's side or bouncing: what was left out would not have mattered."""
    what = read(SCENES / "ball_in_bowl.toml")
    undone = DECISIONS[decision](require(what))
    assert undone is not None
    paths = [simulate(library_of(each), accuracy="tight", until=0.3) for each in (what, undone[1])]
    assert np.abs(paths[0].p - paths[1].p).max() < 1e-12


def two_balls(**keys: object) -> Scene:
    balls = [
        dynamic(
            name, sphere(0.1), mass=1.0, inertia=[4e-3] * 3, position=[x, 0.0, 0.1], velocity=[v, 0.0, 0.0]
        )
        for name, x, v in (("left", 0.0, 1.0), ("right", 1.0, 2.0), ("last", 3.0, 0.0))
    ]
    pairs = [{"between": ["left", "table"]}, {"between": ["right", "table"]}, {"between": ["right", "last"]}]
    pairs.append({"between": ["last", "table"]})
    return scene("bounding_balls", [fixed("table", plane()), *balls], contact=pairs, **keys)


@pytest.mark.parametrize(
    ("observe", "kept"),
    [
        ("left.position", {"left"}),
        ("last.velocity", {"right", "last"}),
        ("right-last.gap", {"right", "last"}),
        ("table.position", {"left", "right", "last"}),
    ],
)
def test_bodies_that_influence_nothing_observed_are_left_out(observe: str, kept: set[str]) -> None:
    """The table does not move: it passes no influence on."""
    model = require(two_balls(observe=[observe]))
    assert {body.name for body in model.bodies} == kept | {"table"}
    assert model.n_q == 3 * len(kept)
    assert len(model.left_out) == 3
    assert model.whole.bodies == two_balls().bodies


def test_what_is_observed_moves_as_in_the_whole_scene() -> None:
    apart = two_balls()
    apart = replace(apart, contacts=tuple(c for c in apart.contacts if c.between[1][0] == "table"))
    whole, part = (
        simulate(library_of(replace(apart, observe=names)), until=0.2) for names in ((), ("left.position",))
    )
    assert part.body_names == ("table", "left")
    np.testing.assert_allclose(whole.p[:, 1], part.p[:, 1], atol=1e-14)


def rocker(lean: float, push: float) -> Scene:
    egg = dynamic(
        "egg", ellipsoid(0.05, 0.04, 0.03), density=1000.0, position=[0.0, 0.0, 0.04], rpy=[0.0, lean, 0.0],
        velocity=[0.1, push, 0.0], angular_velocity=[0.0, 1.0, 0.0],
    )  # fmt: skip
    return scene("rocker", [fixed("table", plane()), egg], contact=[{"between": ["egg", "table"]}])


def test_motion_in_a_plane_is_proved_where_it_is_one() -> None:
    found = in_a_plane(require(rocker(0.3, 0.0)), rhs(rocker(0.3, 0.0)))
    assert found is not None
    assert found.axes == "xz"
    assert found.states == 7
    assert found.instructions < rhs(rocker(0.3, 0.0)).n_instructions() / 2
    assert in_a_plane(require(rocker(0.3, 0.1)), rhs(rocker(0.3, 0.1))) is None


def test_folding_is_not_tried_out_where_each_pair_of_repeated_features_would_be_a_kind() -> None:
    derivation = derive(require(read(SCENES / "gears.toml")))
    assert len(derivation.model.contact_kinds) == 1
    assert "fold" not in {saving.decision for saving in savings_of(derivation)}
