"""Runs of the core from the moment when a flat face leaves a plane, which is where they begin here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from modelgen import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.recording import Recording
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.oracles.glass_reference import Glass
from tests.oracles.pieces import TABLE
from tests.running import library_of

FLAT_START = 1  # MG_START_FLAT


def polynomial(coefficients: Sequence[float]) -> str:
    return " + ".join(f"({float(c)!r})*t**{k}" for k, c in enumerate(coefficients))


def scene_of_glass(glass: Glass, rim: Shape, form: str = "auto") -> Scene:
    """The reference's body with a rim as its only shape, flat on the table at t = 0."""
    force = [*map(polynomial, glass.force), "0"]
    body = make.dynamic(
        "glass",
        rim,
        mass=glass.mass,
        inertia=list(glass.inertia),
        position=[0.0, 0.0, glass.height],
        velocity=[*glass.velocity, 0.0],
        angular_velocity=[0.0, 0.0, glass.spin],
    )
    return make.scene(
        "flat_start",
        [TABLE, body],
        contact=[{"between": ["glass", "table"], "form": form}],
        force=[{"body": "glass", "force": force, "point": [0.0, 0.0, glass.above]}],
        torque=[{"body": "glass", "torque": [*map(polynomial, glass.torque)]}],
    )


@dataclass(frozen=True)
class Rolling:
    """Samples of a run of `glass`, and its ledger."""

    p: np.ndarray  # (n, 3)
    rotation: np.ndarray  # (n, 3, 3)
    eta: np.ndarray
    session: Session
    first: float  # the first step, s
    code: int


def rolled(
    scene: Scene,
    outward: Sequence[float],
    tau: np.ndarray,
    accuracy: Accuracy,
    eta: Sequence[float] = (),
    step: float = 0.05,
) -> Rolling:
    """From flat at t = 0 through the times `tau`; `step` is the first that is tried."""
    session = Session(library_of(scene), accuracy)
    start_flat(session, outward, eta)
    recording, session.run.h = Recording(session, tau), step
    session.advance(tau[-1], 1, recording.record)
    first = float(session.run.t)
    code = session.advance(tau[-1], 20000, recording.record)
    columns = recording.columns()
    rotation = np.swapaxes(recording.arrays["pose"][:, 1, 3:].reshape(-1, 3, 3), -1, -2)
    return Rolling(columns["p"][:, 1], rotation, columns["eta"], session, first, code)


def start_flat(session: Session, outward: Sequence[float], eta: Sequence[float]) -> None:
    """The first contact of each pair starts from flat at the state, as at a hand-over, with one way out."""
    for pair in session.instance["pairs"]:
        i = pair["contacts"][0]
        session.feature_pair[i], session.rolling_start[i] = pair["feature_pairs"][0], FLAT_START
        session.closed[i] = session.active[i] = 1
        session.tilt_direction[3 * i : 3 * i + 3] = outward
    session.eta[: len(eta)] = eta
    session.run.report.margin_min, session.run.report.failed_contact = 1.0, -1
    at_start = Recording(session, np.array([float(session.run.t)]))
    session.advance(float(session.run.t), 0, at_start.record)
    session.run.report.energy_0 = float(at_start.arrays["energy"][0])
