"""A batch is as many runs."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, simulate, simulate_batch, start
from modelgen.errors import SimulationError
from tests.running import scene_of


def test_a_batch_of_one_start_is_the_run_of_the_scene() -> None:
    library = scene_of("ellipsoid_on_ellipsoid")
    instance = library.manifest.instance
    q, u = np.array([instance["initial_q"]] * 3), np.array([instance["initial_u"]] * 3)
    u[1, 5] = 0.3
    batch = simulate_batch(library, q, u, until=0.6, accuracy=Accuracy.tight())
    alone = simulate(library, until=0.6, accuracy=Accuracy.tight(), samples=1)
    assert batch.q[0, :3] == pytest.approx(alone.p[-1, 1], abs=1e-15)
    assert np.array_equal(batch.q[0], batch.q[2])
    assert np.abs(batch.q[1] - batch.q[0]).max() > 1e-3
    assert all(outcome.succeeded for outcome in batch.outcomes)
    assert batch.energy_drift.max() < 1e-11
    assert batch.t == pytest.approx(0.6)


def test_a_batch_names_the_run_that_cannot_start() -> None:
    library = scene_of("ellipsoid_on_plane")
    instance = library.manifest.instance
    q, u = np.array([instance["initial_q"]] * 2), np.array([instance["initial_u"]] * 2)
    q[1, 2] -= 0.01
    with pytest.raises(
        SimulationError, match=r"\(run 1, contact 'egg-table'\): .* by 0\.01 m; at most .* m; move"
    ):
        simulate_batch(library, q, u, until=0.1)
    with pytest.raises(SimulationError, match=r"\(n, 7\)"):
        simulate_batch(library, q[:, :5], u, until=0.1)


def test_a_batch_says_what_its_starts_lack() -> None:
    library = scene_of("ellipsoid_on_plane")
    instance = library.manifest.instance
    q, u = np.array([instance["initial_q"]] * 2), np.array([instance["initial_u"]] * 2)
    lost = u.copy()
    lost[1, 0] = np.nan
    for starts, until, words in (
        ((q, u[:1]), 0.1, r"^u: 1 rows, with 2 of q; as many rows as q; give one row a run$"),
        ((q, lost), 0.1, r"^u\[1\]: not finite; finite numbers, \(n, 6\)$"),
        (([[0.0], [0.0, 1.0]], u), 0.1, r"^q: no array of numbers; finite numbers, \(n, 7\)"),
        ((q[None], u), 0.1, r"^q: shape \(1, 2, 7\)"),
        ((q, u), -1.0, r"^until: -1\.0; a positive time in s"),
    ):
        with pytest.raises(SimulationError, match=words):
            simulate_batch(library, *starts, until=until)  # type: ignore[arg-type]


def test_a_batch_at_rest_measures_its_drift_as_a_run_does() -> None:
    library = scene_of("bouncing_ball")
    instance = library.manifest.instance
    q, u = np.array([instance["initial_q"]]), np.array([instance["initial_u"]])
    q[0, 2] = 0.05
    batch = simulate_batch(library, q, u, until=1.0)
    assert batch.outcomes[0].succeeded
    assert batch.energy_drift[0] < 1e-12


def test_a_coarse_run_alone_in_a_batch_and_step_by_step() -> None:
    library = scene_of("box_dropped")
    instance = library.manifest.instance
    path = simulate(library, until=0.4, accuracy="coarse", samples=1, estimate=False)
    steps = Accuracy.coarse().thresholds.stepping_step * instance["scales"]["time"]
    assert path.accuracy.startswith("coarse")
    assert path.steps == pytest.approx(0.4 / steps, abs=2)
    assert path.penetration_max < 1e-9
    batch = simulate_batch(
        library,
        np.array([instance["initial_q"]]),
        np.array([instance["initial_u"]]),
        until=0.4,
        accuracy="coarse",
    )
    sim = start(library, accuracy="coarse")
    sim.step(until=0.4)
    assert batch.q[0, :3] == pytest.approx(path.p[-1, 1], abs=1e-12)
    assert sim.state[:3] == pytest.approx(path.p[-1, 1], abs=1e-12)
