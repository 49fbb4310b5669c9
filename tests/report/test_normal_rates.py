"""N-dot at the samples of a run is the rate of its normals."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import ModelgenError, derive, normal_rates, read, require, simulate
from tests.running import SCENES, scene_of

SPACING = 1e-4  # s
MOVING = (
    *("ellipsoid_on_ellipsoid", "ellipsoid_in_cavity", "linked_rings", "helix_on_cylinder", "turntable"),
    *("egg_on_spline", "ball_in_torus", "user_surface", "peg_in_hole", "wheel_on_rail", "newton_cradle"),
)


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", MOVING)
def test_it_is_the_derivative_of_the_normals(name: str) -> None:
    """Against differences of order 8 over samples 1e-4 s apart, which lose about 1e-12 of the turning rate
    to their order, and rounding of 1e-16 over the spacing."""
    derivation = derive(require(read(SCENES / f"{name}.toml")))
    path = simulate(scene_of(name), until=400 * SPACING, samples=400, accuracy="tight", estimate=False)
    rates = normal_rates(derivation, path)
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    windows = np.lib.stride_tricks.sliding_window_view(path.normals, 9, axis=0)
    differences = windows @ weights / SPACING
    events = np.array([event.t for event in path.events])
    times = path.t[4:-4]
    smooth = np.array([not (np.abs(events - t) <= 5 * SPACING).any() for t in times])
    known = smooth[:, None] & np.isfinite(differences).all(axis=-1)
    size = np.linalg.norm(path.w, axis=-1).max() + np.abs(differences[known]).max() + 1
    assert known.sum() > 100
    assert np.abs(rates[4:-4] - differences)[known].max() < 1e-8 * size
    assert np.abs((rates * path.normals).sum(axis=-1))[np.isfinite(rates).all(axis=-1)].max() < 1e-12 * size


@pytest.mark.parametrize("name", ["linked_rings", "ellipsoid_in_cavity", "helix_on_cylinder"])
def test_the_normal_turns_where_both_surfaces_are_curved(name: str) -> None:
    path = simulate(scene_of(name), until=0.1, samples=10, estimate=False)
    rates = normal_rates(derive(require(read(SCENES / f"{name}.toml"))), path)
    assert np.nanmax(np.abs(rates)) > 0.1
    assert (np.isnan(rates).all(axis=-1) == (path.feature_pair < 0)).all()


def test_a_run_of_another_scene_is_refused() -> None:
    path = simulate(scene_of("bouncing_ball"), until=0.1, samples=2, estimate=False)
    with pytest.raises(ModelgenError, match="derive the scene of the run"):
        normal_rates(derive(require(read(SCENES / "linked_rings.toml"))), path)
    with pytest.raises(ModelgenError, match="normal_rates: the argument is of type int"):
        normal_rates(3, path)  # type: ignore[arg-type]
