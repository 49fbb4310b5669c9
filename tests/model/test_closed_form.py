"""The composed right-hand side against the same kernels assembled and solved as matrices."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen import derive, read, require
from modelgen.composition.all_sticking_dynamics import why_not_closed
from modelgen.composition.constraint_forces import eliminated
from modelgen.derivation import Derivation
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from modelgen.verification.right_hand_side import check_rhs
from tests.model.scenes import WIDE
from tests.running import SCENES

Array = np.ndarray[Any, Any]


def call(function: ca.Function, *arguments: Any) -> list[Array]:
    return [np.array(value).ravel() for value in function.call([ca.DM(a) for a in arguments])]


def test_ellipsoid_on_a_fixed_plane_takes_at_most_200_instructions() -> None:
    rhs = derive(require(read(SCENES / "ellipsoid_on_plane.toml"))).function("mg_rhs")
    assert rhs.n_instructions() <= 200


@pytest.mark.parametrize("n", [1, 2, 4])
def test_elimination_solves_positive_definite_systems(n: int) -> None:
    random = np.random.default_rng(n)
    root, b = random.normal(size=(n, n)), random.normal(size=n)
    matrix = root @ root.T + np.eye(n)
    A, x = ca.SX.sym("A", n, n), ca.SX.sym("b", n)
    (found,) = call(ca.Function("solve", [A, x], [eliminated(A, x)]), matrix, b)
    np.testing.assert_allclose(matrix @ found, b, rtol=1e-12, atol=1e-13)


def reference(
    derivation: Derivation, t: float, q: Array, u: Array, eta: Array, g: Array
) -> tuple[Array, Array]:
    """udot and forces by M a + J^T lambda = f, J a = -gamma with dense matrices."""
    model = derivation.model
    poses, twists, accels, columns = bodies(derivation, t, q, u, g)
    m = len(model.feature_pairs)
    J, gamma = np.zeros((m, 6 * len(poses))), np.zeros(m)
    for i, entry in enumerate(model.feature_pairs):
        rates = derivation.function(f"mg_{model.contact_kinds[entry.kind].name}_rates")
        sides = [poses[entry.o], twists[entry.o], poses[entry.f], twists[entry.f]]
        at = model.contacts[model.pairs[entry.pair].contacts[0]].eta
        own = eta[at : at + rates.numel_in("eta")]
        arguments = [a[: rates.numel_in(k)] for k, a in enumerate([*sides, own, np.array(entry.parameters)])]
        _, J_o, J_f, gamma_i, _, _ = call(rates, *arguments)
        J[i, 6 * entry.o : 6 * entry.o + len(J_o)], J[i, 6 * entry.f : 6 * entry.f + len(J_f)] = J_o, J_f
        gamma[i] = gamma_i[0]
    inverse = np.zeros((6 * len(poses), 6 * len(poses)))
    for k, body in enumerate(model.bodies):
        inverse[6 * k : 6 * k + 3, 6 * k : 6 * k + 3] = body.mass_inverse[0] * np.eye(3)
        inverse[6 * k + 3 : 6 * k + 6, 6 * k + 3 : 6 * k + 6] = np.reshape(body.mass_inverse[1:], (3, 3))
    free = np.concatenate(accels)
    force = np.linalg.solve(J @ inverse @ J.T, -(J @ free + gamma))
    return (free + inverse @ J.T @ force)[columns], force


def bodies(derivation: Derivation, t: float, q: Array, u: Array, g: Array) -> tuple[Any, ...]:
    model = derivation.model
    poses, twists, wrenches = [], [], [np.zeros(6) for _ in model.bodies]
    accels, columns = [np.zeros(6) for _ in model.bodies], []
    for k, body in enumerate(model.bodies):
        kind = model.body_kinds[body.kind]
        pose, twist = np.r_[np.zeros(3), np.eye(3).ravel()], np.zeros(6)
        if kind.motion == "fixed":
            pose = np.array(body.parameters)
        elif kind.motion == "driven":
            pose, twist, accels[k] = call(derivation.function(f"mg_{kind.name}_path"), t, body.parameters)
        elif kind.motion == "point":
            pose[:3], twist[:3] = q[body.q : body.q + 3], u[body.u : body.u + 3]
        else:
            (pose,) = call(derivation.function(f"mg_{kind.name}_pose"), q[body.q : body.q + 7])
            twist = u[body.u : body.u + 6]
        columns += [6 * k + i for i in range({"point": 3, "free": 6}.get(kind.motion, 0))]
        poses.append(pose)
        twists.append(twist)
    for load in model.loads:
        function = derivation.function(f"mg_{model.load_kinds[load.kind].name}_wrench")
        sides = [part for k in load.bodies for part in (poses[k], twists[k])] + [np.zeros(0)] * 2
        arguments = [a[: function.numel_in(i + 1)] for i, a in enumerate(sides[:4])]
        found = call(function, t, *arguments, load.parameters)
        for k, wrench in zip(load.bodies, found, strict=False):
            wrenches[k] += wrench
    for k, body in enumerate(model.bodies):
        kind = model.body_kinds[body.kind]
        if kind.motion in ("point", "free"):
            n_q, n_u = (7, 6) if kind.motion == "free" else (3, 3)
            own = (
                q[body.q : body.q + n_q],
                u[body.u : body.u + n_u],
                wrenches[k][: n_u if kind.loaded else 0],
            )
            accels[k][:n_u] = call(derivation.function(f"mg_{kind.name}_motion"), *own, g, body.parameters)[1]
    return poses, twists, accels, columns


@pytest.mark.parametrize(
    "name", ["coin", "rattleback", "rolling_disc", "spinning_egg", "sphere_slide_to_roll", "turntable"]
)
def test_a_contact_with_friction_sticks(name: str) -> None:
    """Its friction rows keep J u_dot + gamma = 0, as the normal row does, by the kernels of the kinds."""
    derivation = derive(require(read(SCENES / f"{name}.toml")))
    findings = check_rhs(derivation.function("mg_rhs"), derivation, 20, seed=3)
    assert [finding.quantity for finding in findings] == ["udot", "force"]
    assert all(finding.status != "failed" for finding in findings)


SECOND = """
[[body]]
name = "other"
shape = { kind = "sphere", radius = 0.05 }
density = 1000.0
position = [1.0, 0.0, 0.05]

[[contact]]
between = ["other", "table"]
"""


@pytest.mark.parametrize(
    ("friction", "more", "why"),
    [
        ("{ kinetic = [0.5, 0.2], direction = [1.0, 0.0, 0.0] }", "", "direction"),
        ("1.0", SECOND, "not the only one"),
        ("1.0", "", ""),
    ],
)
def test_friction_has_a_closed_form_at_one_contact_without_direction(
    friction: str, more: str, why: str
) -> None:
    text = (SCENES / "rolling_ellipsoid.toml").read_text()
    model = require(read_text(text.replace("friction = 1.0", f"friction = {friction}") + more, "varied.toml"))
    found = why_not_closed(model)
    assert why in found
    assert bool(found) == bool(why)


@pytest.mark.parametrize(
    ("joint", "more", "why"),
    [
        ({}, {}, ""),
        ({"limits": [-1.0, 1.0]}, {}, "only constraint"),
        ({"armature": 0.1}, {}, "armature"),
        ({"motion": "t"}, {}, "prescribed"),
        ({}, {"contact": [{"between": ["rod", "table"]}]}, "only constraint"),
    ],
)
def test_one_joint_alone_has_a_closed_form(joint: dict[str, Any], more: dict[str, Any], why: str) -> None:
    rod = make.dynamic("rod", make.sphere(0.05), mass=1.0, inertia=[0.1, 0.2, 0.3], position=[0.5, 0.0, 0.4])
    hinge = {"name": "hinge", "kind": "revolute", "between": ["world", "rod"], **joint}
    found = why_not_closed(
        require(make.scene("hung", [make.fixed("table", make.plane()), rod], joint=[hinge], **more))
    )
    assert why in found
    assert bool(found) == bool(why)


@pytest.mark.parametrize("seed", range(5))
def test_composed_and_assembled_accelerations_agree(seed: int) -> None:
    derivation = derive(require(WIDE))
    model, rhs, random = derivation.model, derivation.function("mg_rhs"), np.random.default_rng(seed)
    q, u = np.array(model.initial_q), random.normal(size=model.n_u)
    eta, g, t = random.normal(size=model.n_eta), random.normal(size=3), random.normal()
    entries = (*model.bodies, *model.feature_pairs, *model.loads)
    parameters = [value for entry in entries for value in entry.parameters]
    _, udot, _, force = call(rhs, t, q, u, eta, g, parameters)
    expected_udot, expected_force = reference(derivation, t, q, u, eta, g)
    size = np.abs(expected_udot).max()
    np.testing.assert_allclose(udot, expected_udot, rtol=1e-8, atol=1e-9 * size)
    np.testing.assert_allclose(force, expected_force, rtol=1e-8)
