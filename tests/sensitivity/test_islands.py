"""What happens in one island of bodies at the time of an event in another changes no derivative."""

from __future__ import annotations

from pathlib import Path

import casadi
import numpy as np
import pytest

import modelgen
from modelgen import gradient, sensitivity
from modelgen.runtime.gradient import CROSSING
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable

WORLD = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
"""
ROUND = """
[[body]]
name = "{name}"
shape = {{ kind = "{kind}", {size} }}
density = {density}
position = [{x}, 0.0, {z}]
velocity = [{v}, 0.1, 0.0]
angular_velocity = [0.3, {w}, -0.2]
[[contact]]
between = ["{name}", "floor"]
friction = {mu}
restitution = {e}
"""
HINGED = """
[[body]]
name = "{name}"
shape = {{ kind = "box", size = [0.3, 0.1, 0.05] }}
density = {density}
position = [{x}, 0.0, 2.0]
[[joint]]
kind = "revolute"
name = "{name}_hinge"
between = ["floor", "{name}"]
position = [{hinge}, 0.0, 2.0]
rpy = ["-pi/2", 0.0, 0.0]
limits = [-0.5, {limit}]
restitution = {e}
"""
PARTS = {
    "balls": (ROUND, {"kind": "sphere", "size": "radius = 0.1"}),
    "ellipsoids": (ROUND, {"kind": "ellipsoid", "size": "semi_axes = [0.12, 0.1, 0.08]"}),
    "hinges": (HINGED, {}),
}


def part(kind: str, name: str, x: float, rng: np.random.Generator) -> str:
    template, given = PARTS[kind]
    numbers = {
        "density": rng.uniform(300, 900),
        "z": 0.5 + rng.uniform(0.1, 0.2),
        "v": rng.uniform(0.2, 1.0),
        "w": rng.uniform(-1.0, 1.0),
        "mu": rng.uniform(0.1, 0.5),
        "e": rng.uniform(0.1, 0.8),
        "limit": rng.uniform(0.1, 0.4),
    }
    return template.format(name=name, x=x, hinge=x - 0.15, **given, **numbers)


def of(*names: str) -> list[str]:
    return [f"{name}.{quantity}" for name in names for quantity in ("position", "velocity")]


@pytest.mark.parametrize("kind", PARTS)
@pytest.mark.parametrize("seed", range(3))
def test_bodies_that_never_touch_have_no_derivatives_by_each_other(kind: str, seed: int) -> None:
    """Twins that fall side by side have all their events at one time."""
    one, other = (part(kind, name, x, np.random.default_rng(seed)) for name, x in (("a", 0.0), ("b", 9.0)))
    both, alone = (differentiable(read_text(text, "s.toml")) for text in (WORLD + one + other, WORLD + one))
    by, t = [f"a.{quantity}" for quantity in ("position", "velocity", "angular_velocity")], [0.3, 0.8]
    single = sensitivity(alone, t, of=of("a"), by=by, accuracy="tight")
    found = sensitivity(both, t, of=of("a", "b"), by=by, accuracy="tight")
    assert np.all(found.jacobian[:, 6:] == 0)
    assert found.jacobian[:, :6] == pytest.approx(single.jacobian, rel=1e-7, abs=1e-7)
    assert [verdict.reason for verdict in found.verdicts] == [verdict.reason for verdict in single.verdicts]


@pytest.mark.parametrize("kinds", [("balls", "balls"), ("balls", "hinges"), ("hinges", "ellipsoids")])
def test_gradients_go_back_over_events_in_several_islands(kinds: tuple[str, str]) -> None:
    weights = np.random.default_rng(1).standard_normal(24)
    text = WORLD + "".join(
        part(kind, name, 3.0 * k, np.random.default_rng(3))
        for k, (name, kind) in enumerate(zip("abcd", [*kinds, *kinds], strict=True))
    )
    values = casadi.MX.sym("values", 1, 24)
    loss = casadi.Function("loss", [values], [casadi.dot(values, casadi.DM(weights).T)])
    by = ["a.position", "b.velocity", "c.velocity", "d.angular_velocity"]
    library = differentiable(read_text(text, "s.toml"))
    found = gradient(library, [0.6], loss, of=of(*"abcd"), by=by, accuracy="tight")
    forward = sensitivity(library, [0.6], of=of(*"abcd"), by=by, accuracy="tight", estimate=False)
    assert found.verdict
    assert found.forward_difference < 1e-9
    assert found.gradient == pytest.approx(weights @ forward.jacobian[0], rel=1e-7, abs=1e-7)


def test_more_islands_than_are_told_apart_have_no_derivatives() -> None:
    numbers = {"density": 500.0, "z": 0.5, "v": 0.3, "w": 0.0, "mu": 0.2, "e": 0.5}
    template, given = PARTS["balls"]
    text = WORLD + "".join(
        template.format(name=name, x=k, **given, **numbers) for k, name in enumerate("abcde")
    )
    found = sensitivity(
        differentiable(read_text(text, "s.toml")), [0.2, 0.45], of=of(*"abcde"), by=["e.velocity"]
    )
    assert found.verdicts[0]
    assert found.verdicts[1].reason == "several events happen at one time"
    assert np.all(np.isnan(found.jacobian[1]))


def test_the_tape_has_the_room_that_the_core_needs() -> None:
    header = (Path(modelgen.__file__).parent / "core" / "modelgen.h").read_text()
    assert f"#define MG_TAPE_CROSSING {CROSSING} " in header
