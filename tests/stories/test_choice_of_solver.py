"""The solver of a run by key and by option: the summary tells it, and a wrong one ends with exit code 2."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from modelgen.scene.run_choices import APPROXIMATE

FRICTIONLESS, FRICTIONAL = "bouncing_ball", "sphere_slide_to_roll"
FITTING = [
    *((FRICTIONLESS, name) for name in ("coulomb", "qp", "lcp", "mpcc")),
    *((FRICTIONAL, name) for name in ("coulomb", "mpcc", "polyhedral", "relaxation")),
]
STEPPED = ("--method", "time-stepping", "--step", "0.01", "--until", "0.5", "--no-estimate")


@pytest.mark.parametrize(("scene", "solver"), FITTING)
def test_a_solver_is_chosen_by_option_and_by_key(
    scene: str, solver: str, modelgen: Callable[..., Any], shared_folder: Any
) -> None:
    by_option = modelgen("simulate", f"scenes/{scene}.toml", *STEPPED, "--solver", solver, "--json")
    assert by_option.code == 0, by_option.err
    told = "qp" if (scene, solver) == (FRICTIONLESS, "coulomb") else solver
    assert by_option.json["solver"] == told
    assert by_option.json["solves"][told] > 0
    text = (shared_folder / "scenes" / f"{scene}.toml").read_text()
    keys = f'[run]\nsolver = "{solver}"\nmethod = "time-stepping"\nstep = 0.01\n'
    (shared_folder / "chosen.toml").write_text(text.replace("[run]\n", keys))
    by_key = modelgen("simulate", "chosen.toml", "--until", "0.5", "--no-estimate", "--json")
    assert by_key.code == 0, by_key.err
    assert by_key.json["solver"] == told
    assert by_key.json["final"] == by_option.json["final"]
    shown = modelgen("simulate", f"scenes/{scene}.toml", *STEPPED, "--solver", solver)
    assert f"by {told}" in shown.out


@pytest.mark.parametrize("solver", APPROXIMATE)
def test_a_law_in_the_place_of_coulombs_needs_time_stepping(
    solver: str, modelgen: Callable[..., Any], shared_folder: Any
) -> None:
    text = (shared_folder / "scenes" / f"{FRICTIONAL}.toml").read_text()
    (shared_folder / "chosen.toml").write_text(text.replace("[run]\n", f'[run]\nsolver = "{solver}"\n'))
    answer = modelgen("check", "chosen.toml")
    assert answer.code == 2
    assert "chosen.toml" in answer.err
    assert 'method = "time-stepping" with it' in answer.err


@pytest.mark.parametrize(("scene", "solver"), [(FRICTIONLESS, "relaxation"), (FRICTIONAL, "qp")])
def test_a_solver_that_a_scene_cannot_have_is_refused(
    scene: str, solver: str, modelgen: Callable[..., Any]
) -> None:
    answer = modelgen("simulate", f"scenes/{scene}.toml", *STEPPED, "--solver", solver)
    assert answer.code == 2
    assert f"solver: '{solver}'" in answer.err
    assert "leave it out, or choose one of these" in answer.err
