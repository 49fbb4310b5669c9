"""Joints in results: forces and torques, coordinates with whole turns counted, warnings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session

Array = np.ndarray[Any, Any]
TURN = 2 * np.pi


def joint_columns(
    session: Session, kept: Mapping[str, Array], rotation: Array, runs: int
) -> dict[str, Array]:
    """`joint_force`, `joint_torque` (n, nj, 3), world, on the second body at the origin of its frame, and
    `coordinates` (n, number of them).

    Args:
        rotation: (n, nb, 3, 3) body -> world.
        runs: how many runs the samples are of, of each as many, one run after the other.
    """
    joints, wrench = session.instance["joints"], kept["joint_wrench"]
    force, torque = wrench[..., :3].copy(), np.zeros_like(wrench[..., :3])
    columns = [np.zeros((len(wrench), 0), dtype=wrench.dtype)]
    for k, joint in enumerate(joints):
        turned = rotation[:, joint["b"]]
        lever = turned @ np.array(joint["anchor"])
        torque[:, k] = np.einsum("nij,nj->ni", turned, wrench[:, k, 3:]) - np.cross(lever, force[:, k])
        columns.append(_coordinates(session, k, kept, rotation, runs))
    return {"joint_force": force, "joint_torque": torque, "coordinates": np.concatenate(columns, axis=1)}


def _coordinates(session: Session, k: int, kept: Mapping[str, Array], rotation: Array, runs: int) -> Array:
    joint = session.instance["joints"][k]
    listed = session.library.manifest.kinds["joint"][joint["kind"]]["coordinates"]
    values: Array = kept["coordinate"][:, k, : len(listed)].copy()
    axis = rotation[:, joint["b"]] @ np.array(joint["parameters"][21:24])  # z of the frame in b
    spins = [np.einsum("nij,nj->ni", rotation[:, joint[s]], kept["twist"][:, joint[s], 3:]) for s in "ab"]
    rate = np.einsum("ni,ni->n", axis, spins[1] - spins[0])
    t, rate = (each.reshape(runs, -1).T for each in (kept["t"], rate))
    for column, each in enumerate(listed):
        angle = values[:, column].reshape(runs, -1).T
        if each["name"] == "angle":
            values[:, column] = counted(t, angle, rate).T.ravel()
        elif each["measure"] == "angle":
            values[:, column] = np.unwrap(angle, axis=0).T.ravel()
    return values


def counted(t: Array, angle: Array, rate: Array) -> Array:
    """Angles (n, ...) with whole turns counted; the rates tell how far each turned since a sample before."""
    turns = np.zeros_like(angle)
    for i in range(1, len(angle)):
        foretold = angle[i - 1] + turns[i - 1] + (rate[i - 1] + rate[i]) / 2 * (t[i] - t[i - 1])
        turns[i] = TURN * np.round((foretold - angle[i]) / TURN)
    return angle + turns


def joint_warnings(session: Session, accuracy: Accuracy) -> list[str]:
    """Redundant joints, singular configurations, and velocities at the start that did not fit."""
    if not session.joints:
        return []
    return [*_misfit(session), *session.redundant_joints, *_singular(session, accuracy)]


def redundancy(session: Session) -> list[str]:
    """Joints with rows that depend on those of the joints before them, at the session's state."""
    kinds, found = session.library.manifest.kinds["joint"], []
    for joint, rank in zip(session.instance["joints"], session.ranks(), strict=True):
        rows = int(kinds[joint["kind"]]["rows"])
        if rank < rows:
            found.append(
                f"joint {joint['name']!r} is redundant: {rows - rank} of its {rows} rows follow from the "
                "joints listed before it; the motion is unique, the joint forces given are those of least "
                "weighted norm"
            )
    return found


def _misfit(session: Session) -> list[str]:
    speed, scales = float(session.run.report.joint_speed), session.instance["scales"]
    if speed <= float(session.settings.start_joint_gap) * scales["length"] / scales["time"]:
        return []
    name = session.joints[session.run.report.failed_joint]
    return [
        f"the velocities at the start do not fit joint {name!r} by {speed:.3g} m/s; the nearest ones "
        "that fit, by kinetic energy, were taken"
    ]


def _singular(session: Session, accuracy: Accuracy) -> list[str]:
    report, found = session.run.report, []
    if report.dead_centres:
        name, t = session.joints[report.dead_centre], float(report.dead_centre_t)
        found.append(
            f"the joints were singular {report.dead_centres} times, first before t = {t:.6g} s, where joint "
            f"{name!r} lost a row to the joints before it: at such a dead centre the linkage could have gone "
            "on another way; it went on as it came"
        )
    if 0 <= report.rank_min < report.rank_max:
        found.append(
            f"the rows of the joints had rank {report.rank_min} at some steps and {report.rank_max} at "
            "others: there the joints alone do not say how the linkage goes on, and the least acceleration "
            "was taken"
        )
    elif float(report.joint_margin_min) < accuracy.thresholds.margin_warn**2:
        found.append(
            f"joint {session.joints[report.joint_margin]!r} came near to losing a row to the joints before "
            f"it at t = {float(report.joint_margin_t):.6g} s "
            f"(own part {float(report.joint_margin_min):.1e}): a dead centre"
        )
    return found
