"""Plans without freedom against runs, the system of a scene against the core, and the worked examples."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen import derive, read, require, start
from modelgen.casadi_functions.complementarity import mpcc
from modelgen.composition.complementarity_system import complementarity_system
from modelgen.composition.contact_mode import named_feature_pairs
from modelgen.errors import ModelgenError
from modelgen.optimal_control.followed_plan import followed
from modelgen.optimal_control.transcription import Transcription
from tests.benchmarks.plans import NAMES, NEAR, solved
from tests.examples import masse_shot, throw_a_cube
from tests.running import SCENES, scene_of

Array = np.ndarray[Any, Any]


@pytest.mark.cases(3)
@pytest.mark.parametrize(("stages", "order"), [(1, 1), (2, 3), (3, 5), (4, 7)])
@pytest.mark.parametrize("name", ["ellipsoid_on_plane", "rolling_ellipsoid"])
def test_a_plan_without_freedom_converges_to_the_run(name: str, stages: int, order: int) -> None:
    """The positions of Radau IIA on constraints of positions have order 1, 3, 5 and 7 (Hairer and Wanner,
    VII)."""
    derivation, library = derive(require(read(SCENES / f"{name}.toml"))), scene_of(name)
    model, errors = derivation.model, []
    for n in (6, 12):
        plan = Transcription(derivation, 0.1, n, stages=stages, impacts=False)
        guess = plan.guess(library)
        plan.start_at(guess[: model.n_q], guess[model.n_q : model.n_q + model.n_u])
        found = plan.solve(guess, (1e-9,))
        assert found.solution.success
        end = followed(library, found.t, found.x, found.inputs)[-1]
        errors.append(np.abs(end - found.x[-1])[: model.n_q].max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)


def test_the_system_of_a_scene_has_the_equations_of_the_core() -> None:
    """M v_dot = f_v + J lambda with the accelerations and normal forces of a run."""
    model = require(read(SCENES / "balancing_wheel.toml"))
    system, run = mpcc(model), start(scene_of("balancing_wheel"))
    run.step(0.3)
    session = run.session
    x, slope = np.array(session.x), np.zeros_like(session.x)
    session.evaluate(run.t, x, slope)
    names = ("t", "x", "u", "gravity", "p")
    given = [run.t, x[:-1], session.applied_input[:-1], system["g0"], system["p0"]]
    outputs = ["M", "f_v", "J_normal", "J_tangent", "J_joint", "q_dot", "f_c"]
    function = ca.Function("system", [system[name] for name in names], [system[name] for name in outputs])
    M, f_v, J_n, J_t, J_j, q_dot, f_c = (np.array(each) for each in function(*given))
    v_dot = slope[model.n_q : model.n_q + model.n_u]
    np.testing.assert_allclose(q_dot.ravel(), slope[: model.n_q], rtol=1e-12, atol=1e-12)
    assert abs(f_c[0, 0]) < 1e-9
    push = M @ v_dot - f_v.ravel() - J_n @ session.force[:1]
    others = np.hstack([J_t, J_j])
    left = push - others @ np.linalg.lstsq(others, push, rcond=None)[0]
    assert np.abs(left).max() < 1e-9 * np.abs(f_v).max()


def test_contacts_that_rebound_are_refused() -> None:
    derivation = derive(require(read(SCENES / "bouncing_ball.toml")))
    with pytest.raises(ModelgenError, match="rebounds"):
        Transcription(derivation, 1.0, 4)
    with pytest.raises(ModelgenError, match="1 to 4 stages"):
        Transcription(derivation, 1.0, 4, stages=5, impacts=False)


@pytest.mark.parametrize(
    "name",
    [
        "roll_an_ellipsoid",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("put_a_coin_on_its_edge", "balance_the_wheel")
        ),
    ],
)
def test_a_worked_example_is_solved_from_its_guess(name: str) -> None:
    example = import_module(f"tests.examples.{name}").problem()
    found = example.plan.solve(example.guess, solver=example.solver())
    assert found.solution.success
    assert found.solution.complementarity < 1e-9
    assert example.missed(example.simulated(found)[-1]) < 1e-3
    assert example.reproduced(found)[0] < 1e-3


@pytest.mark.parametrize(("name", "held"), [("balancing_wheel", 1), ("rolling_disc", 0), ("bicycle", 0)])
def test_friction_across_the_plane_of_a_planar_body_is_left_out(name: str, held: int) -> None:
    """Its direction has a component that is zero whatever the slip; others follow the slip."""
    model = require(read(SCENES / f"{name}.toml"))
    pairs = tuple(named_feature_pairs(model, ()))
    system = complementarity_system(model, derive(model).functions(), pairs, ca.SX)
    friction = ca.vertcat(*system.equal)
    slips = ca.which_depends(friction, system.scene.symbols.u, 1, True)
    assert len(slips) - sum(slips) == held


@pytest.mark.slow
def test_a_plan_whose_contact_changes_at_ends_of_elements_is_followed_to_a_millionth() -> None:
    """The ball slides, then rolls; the ends of the elements move to that instant."""
    example = masse_shot.problem()
    found = example.plan.solve(example.guess, solver=example.solver())
    assert found.solution.success
    assert example.reproduced(found)[0] < 1e-6
    assert example.missed(example.simulated(found)[-1]) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_worked_examples_converge_from_perturbed_starts(name: str) -> None:
    example = import_module(f"tests.examples.{name}").problem()
    solver = example.solver()
    rows = [solved(example, solver, seed) for seed in range(20)]
    assert sum(row["missed"] < NEAR for row in rows) >= 18


@pytest.mark.slow
def test_a_thrown_cube_ends_on_its_face() -> None:
    throw = throw_a_cube.problem()
    found = throw_a_cube.by_derivatives(throw, throw_a_cube.FIRST)
    assert throw.reached(found)
    assert not throw.ends_on_the_face(throw_a_cube.ELSEWHERE)


@pytest.mark.slow
def test_throws_of_a_cube_converge_from_perturbed_starts() -> None:
    throw = throw_a_cube.problem()
    starts = (throw_a_cube.perturbed(np.random.default_rng(seed)) for seed in range(20))
    assert sum(throw.reached(throw_a_cube.by_derivatives(throw, start)) for start in starts) >= 18
