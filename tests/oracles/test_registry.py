"""Every shipped scene, at every accuracy and in every regular form, keeps what the registry promises."""

from __future__ import annotations

import ast
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from modelgen import Accuracy, read, require, simulate
from modelgen.runtime.trajectory import Outcome, Trajectory
from tests.registry import REGISTRY, forced, forms_of
from tests.running import SCENES

TESTS = Path(__file__).parents[1]
ACCURACIES = ("fast", "balanced", "tight")
COMPLEMENTARITY = dict(zip(ACCURACIES, (1e-7, 1e-10, 1e-10), strict=True))


def all_forms_at_least_once() -> set[str]:
    """Scenes that show all forms between them, those with the most new ones first."""
    left = {form for shipped in REGISTRY.values() for form in shipped.forms}
    chosen = set()
    while left:
        best = max(REGISTRY, key=lambda name: len(left & set(REGISTRY[name].forms)))
        chosen.add(best)
        left -= set(REGISTRY[best].forms)
    return chosen


IN_ALL_FORMS = all_forms_at_least_once()
FORCED = [
    pytest.param(name, form, marks=() if k == 0 or name in IN_ALL_FORMS else pytest.mark.slow)
    for name, shipped in REGISTRY.items()
    for k, form in enumerate(shipped.forms or ("auto",))
]
SEVERAL = [
    pytest.param(name, marks=() if name in IN_ALL_FORMS else pytest.mark.slow)
    for name, shipped in REGISTRY.items()
    if len(shipped.forms) > 1
]


@cache
def path_of(name: str, form: str, accuracy: str) -> Trajectory:
    return simulate(forced(name, form), accuracy=Accuracy.named(accuracy), estimate=False)


def test_the_registry_lists_every_scene_file() -> None:
    assert {path.stem for path in SCENES.iterdir()} == set(REGISTRY)


@pytest.mark.cases(8)
@pytest.mark.parametrize("name", REGISTRY)
def test_the_registry_lists_every_regular_form(name: str) -> None:
    assert forms_of(name) == set(REGISTRY[name].forms)


@pytest.mark.parametrize("name", REGISTRY)
def test_every_scene_has_a_test_against_its_reference(name: str) -> None:
    path, _, wanted = REGISTRY[name].reference.partition("::")
    tree = ast.parse((TESTS / path).read_text(encoding="utf-8"))
    assert wanted in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert name in ast.unparse(next(node for node in tree.body if getattr(node, "name", "") == wanted))


@pytest.mark.cases(8)
@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize(("name", "form"), FORCED)
def test_a_scene_runs_to_its_end_within_its_bounds(name: str, form: str, accuracy: str) -> None:
    path, library = path_of(name, form, accuracy), forced(name, form)
    length = library.manifest.instance["scales"]["length"]
    assert path.outcome is Outcome.DONE
    assert path.t_end == path.t[-1] == library.manifest.instance["run"]["until"]
    followed = path.feature_pair >= 0
    numbers = (path.p, path.quaternion, path.v, path.w, path.eta, path.force)
    numbers += (path.gap[followed], path.points_o[followed], path.points_f[followed], path.normals[followed])
    assert all(np.isfinite(array).all() for array in numbers)
    assert np.isnan(path.gap[~followed]).all()
    assert path.energy_drift < REGISTRY[name].drift[ACCURACIES.index(accuracy)]
    assert path.gap_max < 1e-10 * length * REGISTRY[name].loose
    assert path.complementarity_max < COMPLEMENTARITY[accuracy] * REGISTRY[name].loose
    assert path.margin_min > REGISTRY[name].margin


@pytest.mark.cases(12)
@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize(("name", "form"), FORCED)
def test_events_are_those_of_the_registry(name: str, form: str, accuracy: str) -> None:
    found, expected = (
        Counter(event.kind for event in path_of(name, form, accuracy).events),
        REGISTRY[name].events,
    )
    assert set(found) == set(expected)
    tight = accuracy == "tight"
    counts = {kind: count[tight] if isinstance(count, tuple) else count for kind, count in expected.items()}
    for kind, count in counts.items():
        assert accuracy == "fast" or count is None or found[kind] == count


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", SEVERAL)
def test_all_forms_end_in_the_same_state(name: str) -> None:
    first, *others = (path_of(name, form, "tight") for form in REGISTRY[name].forms)
    for other in others:
        assert np.abs(other.p[-1] - first.p[-1]).max() < REGISTRY[name].apart
        assert np.abs(other.quaternion[-1] - first.quaternion[-1]).max() < 100 * REGISTRY[name].apart


@pytest.mark.cases(12)
@pytest.mark.parametrize("name", REGISTRY)
def test_a_scene_requires_these_kinds(name: str) -> None:
    model = require(read(SCENES / f"{name}.toml"))
    groups = (
        *(model.body_kinds, model.contact_kinds, model.load_kinds),
        *(model.joint_kinds, model.limit_kinds),
    )
    assert tuple(kind.name for group in groups for kind in group) == REGISTRY[name].kinds
