"""Many runs of one library from different starts, in one call of the core."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import check_span, checked_starts, with_parameters
from modelgen.runtime.core_session import Session
from modelgen.runtime.interruptible_advance import interruptible
from modelgen.runtime.lane_arrays import lanes_of
from modelgen.runtime.settings import accuracy_without_scene
from modelgen.runtime.start import REFUSED, refusal
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Outcome, doubt_kinds


@dataclass(frozen=True, slots=True)
class Batch:
    """The ends of n runs, q and u laid out as in the manifest's instance (offsets `q` and `u` of a body)."""

    q: Array  # (n, n_q) m and unit quaternions (w, x, y, z)
    u: Array  # (n, n_u) m/s in world axes, rad/s in body axes
    t: Array  # (n,) s, where each run came
    outcomes: tuple[Outcome, ...]
    energy_drift: Array  # (n,) max |E - E_0 - work| over the largest kinetic energy
    steps: Array  # (n,)
    doubts: tuple[tuple[str, ...], ...]  # what the figures of each run speak against, of DOUBT_KINDS


def simulate_batch(
    library: Library,
    q: Array,
    u: Array,
    *,
    until: float,
    accuracy: Accuracy | str | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Batch:
    """Run one scene from n starts.

    Args:
        library: what `build` returned.
        q: (n, n_q) positions (m, world) and quaternions at t = 0, in the order of the manifest.
        u: (n, n_u) velocities (m/s, world; rad/s, body axes).
        until: end time, s.
        accuracy: as for `simulate`; `balanced` when None.
        parameters: as for `simulate`, the same in all runs.

    Raises:
        SimulationError: the shapes do not fit, or a start interpenetrates; names the run and the contact.
    """
    expect("simulate_batch", library, Library)
    check_span("until", until, "give the end of the runs")
    library = with_parameters(library, parameters)
    session = Session(library, accuracy_without_scene(library.manifest.instance, accuracy))
    n_q, n_u = session.instance["n_q"], session.instance["n_u"]
    starts = np.concatenate(_as_many(checked_starts("q", q, n_q), checked_starts("u", u, n_u)), axis=1)
    n = len(starts)
    runs, kept = lanes_of(session, n)
    x = kept["x"]
    x[:, : n_q + n_u] = starts
    codes = np.zeros(n, dtype=np.intc)
    interruptible(lambda: session.batch(runs, until, codes), kept["stop"])
    _refuse(session, codes, runs, kept)
    return Batch(
        q=x[:, :n_q],
        u=x[:, n_q : n_q + n_u],
        t=np.array([float(run.t) for run in runs]),
        outcomes=tuple(OUTCOME_OF_CODE[code] for code in codes.tolist()),
        energy_drift=np.array([session.energy_drift(run) for run in runs]),
        steps=np.array([run.steps for run in runs]),
        doubts=tuple(
            doubt_kinds(session.doubts(run, code)) for run, code in zip(runs, codes.tolist(), strict=True)
        ),
    )


def _as_many(q: Array, u: Array) -> tuple[Array, Array]:
    if len(q) != len(u):
        found = f"{len(u)} rows, with {len(q)} of q"
        raise SimulationError("u", found, "as many rows as q", "give one row a run")
    return q, u


def _refuse(
    session: Session, codes: Array, runs: ctypes.Array[ctypes.Structure], kept: dict[str, Array]
) -> None:
    for index, (code, run) in enumerate(zip(codes.tolist(), runs, strict=True)):
        if code in REFUSED:
            session.x[:], session.feature_pair[:-1] = kept["x"][index], kept["feature_pair"][index][:-1]
            raise refusal(session, code, run, f"run {index}, ")
