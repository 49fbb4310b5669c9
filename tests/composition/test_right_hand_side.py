"""The composed right-hand side against the core, along runs of every shipped scene, and its derivatives."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen import as_casadi, derive, emit, read, require, start
from modelgen.casadi_functions.as_casadi import mode_of, rhs_arguments, step_arguments
from modelgen.casadi_functions.compiled_function import save_external
from modelgen.composition.contact_mode import (
    ContactMode,
    FrictionMode,
    contact_count,
    friction_of_contacts,
    mode_numbers,
    own_feature_pairs,
)
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError
from modelgen.runtime.stepped_simulation import Simulation
from modelgen.scene.read import read_text
from tests.registry import REGISTRY
from tests.running import SCENES, compiled, scene_of

Array = np.ndarray[Any, Any]
RUBS = {"block_on_incline", "cube_toss", "sliding_puck"}  # whose faces slip: refused while they do
STATES = 4


def derived(name: str) -> Derivation:
    return derive(require(read(SCENES / f"{name}.toml")))


def states(name: str, derivation: Derivation) -> Iterator[Simulation]:
    """A run of a shipped scene at some times."""
    until = derivation.model.scene.run.until or 1.0
    simulation = start(scene_of(name))
    random = np.random.default_rng(len(name))
    for t in np.sort(random.uniform(0, until, STATES)):
        if simulation.outcome is None:
            simulation.step(float(t))
            yield simulation


def values(function: ca.Function, *arguments: Any) -> list[Array]:
    return [np.array(value).ravel() for value in function.call([ca.DM(each) for each in arguments])]


def of_the_core(derivation: Derivation, simulation: Simulation) -> list[Array]:
    """udot, eta_dot, and the normal forces of contacts and limits."""
    model, session = derivation.model, simulation.session
    x, slope = np.array(session.x), np.zeros_like(session.x)
    session.evaluate(simulation.t, x, slope)
    n = model.n_q + model.n_u
    return [slope[model.n_q : n], slope[n:-1], np.array(session.force[: contact_count(model)])]


def assert_same(derivation: Derivation, found: list[Array], expected: list[Array]) -> None:
    """To 1e-10 of the largest entry, or of the scene's own scale."""
    scales = derivation.model.scales
    accel = scales.length / scales.time**2
    units = (max(accel, accel / scales.length), 1.0 / scales.time, scales.mass * accel)
    for got, wanted, unit in zip(found, expected, units, strict=True):
        size = max(float(np.abs(wanted).max(initial=0.0)), unit)
        np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-10 * size)


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", sorted(REGISTRY))
def test_accelerations_rates_and_forces_are_those_of_the_core(name: str) -> None:
    derivation, refused = derived(name), 0
    for simulation in states(name, derivation):
        expected = of_the_core(derivation, simulation)
        given = rhs_arguments(derivation.model, simulation)
        try:
            mode = mode_of(derivation, simulation)
        except ModelgenError as error:
            if "slips" not in str(error):
                raise
            refused += 1
            continue
        n = contact_count(derivation.model)
        _, udot, eta_dot, force = values(as_casadi(derivation, mode=simulation), *given)
        assert_same(derivation, [udot, eta_dot, force[:n]], expected)
        if mode.patches:
            continue
        function = derivation.rhs(feature_pairs=mode.feature_pairs)
        vector = mode_numbers(mode, int(function.numel_out("force")))
        _, udot, eta_dot, force = values(function, *given, vector)
        assert_same(derivation, [udot, eta_dot, force[:n]], expected)
    assert bool(refused) == (name in RUBS)


@pytest.mark.cases(6)
@pytest.mark.parametrize("name", sorted(set(REGISTRY) - RUBS))
def test_its_derivatives_are_those_of_differences(name: str) -> None:
    """Along random directions of state and parameters, by central differences extrapolated once; where rows
    are dependent, directions must keep them so, and others are not looked at."""
    derivation = derived(name)
    simulation = list(states(name, derivation))[-1]
    if mode_of(derivation, simulation).redundant:
        return
    given = rhs_arguments(derivation.model, simulation)
    function = as_casadi(derivation, mode=simulation)
    random = np.random.default_rng(1)
    along = [1e-4 * random.normal(size=each.shape) * np.maximum(np.abs(each), 0.01) for each in given]
    slope = values(function.forward(1), *given, *values(function, *given), *along)

    def difference(h: float) -> list[Array]:
        ends = [
            values(function, *(a + s * h * b for a, b in zip(given, along, strict=True))) for s in (1, -1)
        ]
        return [(after - before) / (2 * h) for after, before in zip(*ends, strict=True)]

    for got, whole, half in zip(slope, difference(1.0), difference(0.5), strict=True):
        expected = (4 * half - whole) / 3
        size = np.abs(expected).max(initial=0.0)
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-5 * size + 1e-9)


@pytest.mark.parametrize("name", ["balancing_wheel", "gripper", "double_pendulum"])
def test_derivatives_are_finite_while_contacts_are_open(name: str) -> None:
    derivation = derived(name)
    simulation = next(states(name, derivation))
    function = derivation.rhs()
    model, rows = derivation.model, int(function.numel_out("force"))
    off = tuple(FrictionMode() for _ in friction_of_contacts(model))
    mode = ContactMode(own_feature_pairs(model), (False,) * contact_count(model), off)
    given = [*rhs_arguments(model, simulation), np.array(mode_numbers(mode, rows))]
    jacobian = function.jacobian()
    found = values(jacobian, *given, *values(function, *given))
    assert all(np.isfinite(each).all() for each in found)


@pytest.mark.parametrize("name", ["rolling_ellipsoid", "balancing_wheel", "four_bar"])
def test_a_step_is_that_of_the_core(name: str) -> None:
    derivation, h = derived(name), 1e-3
    simulation = start(scene_of(name), method="rk4", step=h)
    simulation.step(0.02)
    step = as_casadi(derivation, "step", mode=simulation, h=h, settle=False)
    found = values(step, *step_arguments(derivation.model, simulation))
    simulation.session.smooth(1)
    np.testing.assert_allclose(found[0], simulation.session.x[:-1], rtol=1e-12, atol=1e-13)
    if derivation.model.scene.sensors:
        simulation.session.sense()
        np.testing.assert_allclose(found[1], simulation.session.sensed[:-1], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("method", "order", "h"), [("euler", 1, 2e-3), ("rk4", 4, 0.04), ("dop853", 8, 0.2)])
def test_a_step_has_the_order_of_its_method(method: Any, order: int, h: float) -> None:
    """The error of one step falls by 2^(order + 1) when it is halved; the reference takes many steps."""
    derivation = derived("rolling_ellipsoid")
    simulation = start(scene_of("rolling_ellipsoid"))
    simulation.step(0.02)
    x, *rest = step_arguments(derivation.model, simulation)
    make = {"mode": simulation, "settle": False}
    fine = as_casadi(derivation, "step", method="dop853", **make)  # type: ignore[arg-type]
    step = as_casadi(derivation, "step", method=method, **make)  # type: ignore[arg-type]
    errors = []
    for span in (h, h / 2):
        end = x
        for k in range(8):
            (end,) = values(fine, end, *rest[:-1], rest[-1] + k * span / 8, span / 8)
        errors.append(np.abs(values(step, x, *rest, span)[0] - end).max())
    assert np.log2(errors[0] / errors[1]) > order + 0.5


EXTERNAL = """
import casadi as ca, numpy as np, sys
step = ca.external("step", sys.argv[1])
given = np.load(sys.argv[2])
x = [ca.DM(given[name]) for name in given.files]
names = ["x_next", "jac:x_next:x", "jac:x_next:p"]
found = step.factory("slopes", step.name_in(), names).call(x)
assert not [name for name in sys.modules if name.startswith("modelgen")]
np.savez(sys.argv[3], *[np.array(each) for each in found])
"""


def test_an_external_has_the_same_values_and_derivatives_in_a_process_without_modelgen(
    tmp_path: Path,
) -> None:
    derivation = derived("rolling_ellipsoid")
    simulation = start(scene_of("rolling_ellipsoid"))
    simulation.step(0.02)
    step = as_casadi(derivation, "step", mode=simulation, h=1e-3)
    given = step_arguments(derivation.model, simulation)
    target = save_external(step, tmp_path, level="O1")
    np.savez(tmp_path / "given.npz", *given)
    (tmp_path / "use.py").write_text(EXTERNAL, encoding="utf-8")
    free = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    words = [sys.executable, "use.py", str(target), "given.npz", "found.npz"]
    subprocess.run(words, cwd=tmp_path, env=free, check=True)
    names = ["x_next", "jac:x_next:x", "jac:x_next:p"]
    expected = values(step.factory("slopes", step.name_in(), names), *given)
    found = np.load(tmp_path / "found.npz")
    for wanted, name in zip(expected, found.files, strict=True):
        np.testing.assert_allclose(found[name].ravel(), wanted, rtol=1e-9, atol=1e-12)


def test_a_wrong_mode_is_refused() -> None:
    derivation = derived("rolling_ellipsoid")
    with pytest.raises(ModelgenError, match="mode: active: 2 entries"):
        as_casadi(derivation, mode=ContactMode((0,), (True, True), ()))
    with pytest.raises(ModelgenError, match="known: rhs, step"):
        as_casadi(derivation, "stepp")  # type: ignore[arg-type]
    with pytest.raises(ModelgenError, match="no contact 'egg'"):
        as_casadi(derivation, feature_pairs={"egg": "v0"})


SWUNG = """
[[parameter]]
name = "radius"
value = 0.1

[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
shape = { kind = "sphere", radius = "radius" }
density = 1000.0
position = [0.0, 0.0, "radius"]

[[contact]]
between = ["ball", "table"]
"""


def test_a_library_whose_scene_has_parameters_is_read_again() -> None:
    derivation = derive(require(read_text(SWUNG, "ball.toml")))
    library = compiled(emit(derivation))
    given = rhs_arguments(derivation.model, start(library))
    mode = np.array([1.0, 0.0])
    for got, wanted in zip(
        values(as_casadi(library), *given, mode), values(derivation.rhs(), *given, mode), strict=True
    ):
        np.testing.assert_array_equal(got, wanted)
    with pytest.raises(ModelgenError, match="cannot be read again"):
        as_casadi(scene_of("rolling_ellipsoid"))
