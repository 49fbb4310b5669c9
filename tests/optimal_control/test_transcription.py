"""Plans without freedom against runs, the system of a scene against the core, and the worked examples."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen import derive, read, require, start
from modelgen.casadi_functions.complementarity import mpcc
from modelgen.errors import ModelgenError
from modelgen.optimal_control.motion_guess import followed
from modelgen.optimal_control.transcription import Transcription
from tests.examples import masse_shot, roll_an_ellipsoid
from tests.running import SCENES, scene_of

Array = np.ndarray[Any, Any]


@pytest.mark.parametrize(("stages", "order"), [(1, 1), (2, 3), (3, 5)])
@pytest.mark.parametrize("name", ["ellipsoid_on_plane", "rolling_ellipsoid"])
def test_a_plan_without_freedom_converges_to_the_run(name: str, stages: int, order: int) -> None:
    """The positions of Radau IIA on constraints of positions have order 1, 3 and 5 (Hairer and Wanner, VII)."""
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
    with pytest.raises(ModelgenError, match="1 to 3 stages"):
        Transcription(derivation, 1.0, 4, stages=4, impacts=False)


@pytest.mark.parametrize("example", [roll_an_ellipsoid, masse_shot], ids=lambda each: each.__name__)
def test_a_worked_example_is_solved_in_short(example: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """With half as many elements and two relaxations."""
    monkeypatch.setattr(example, "ELEMENTS", 6)
    plan, library, guess = example.problem()
    found = plan.solve(guess, (1e-4, 1e-6))
    assert found.solution.success
    assert example.missed(library, found) < 1e-2


@pytest.mark.slow
@pytest.mark.parametrize("example", [roll_an_ellipsoid, masse_shot], ids=lambda each: each.__name__)
def test_worked_examples_converge_from_perturbed_guesses(example: ModuleType) -> None:
    plan, library, _ = example.problem()
    solver, random, good = plan.solver(), np.random.default_rng(0), 0
    for _ in range(20):
        found = plan.solve(example.perturbed(plan, library, random), solver=solver)
        good += found.solution.success and example.missed(library, found) < 1e-3
    assert good >= 18
