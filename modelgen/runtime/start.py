"""The start of a run: the core settles it on its constraints, or it is refused with the reason."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import inf
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.core_session import Session
from modelgen.runtime.joint_results import redundancy
from modelgen.runtime.tables.ctypes_structures import Array

PENETRATION, NO_EXTREMUM, NO_SIDE, JOINT_APART, BODY_WITHIN = 10, 11, 12, 13, 14
ALONG_Z = ("revolute", "cylindrical", "screw", "planar")  # kinds of joint that keep the z axes together
TURNED = ("prismatic", "weld")  # that keep all axes so
ONLY_PLACES = ("spherical", "distance", "rope")
REFUSED = (PENETRATION, NO_EXTREMUM, NO_SIDE, JOINT_APART, BODY_WITHIN)


def begin(session: Session) -> None:
    """Settle the start of a session.

    Raises SimulationError where bodies interpenetrate, joints are apart, or no closest points are found.
    """
    if session.may_take_long:
        from modelgen.runtime.interruptible_advance import interruptible  # not every scene needs it

        code = interruptible(session.begin, session.stop)
    else:
        code = session.begin()
    if code in REFUSED:
        raise refusal(session, code, session.run)
    session.redundant_joints = redundancy(session) if session.joints else []


def refusal(session: Session, code: int, run: Any, label: str = "") -> SimulationError:
    """The error of the code of an mg_run at the session's state; `label` says which of several runs it is."""
    if code == JOINT_APART:
        return _apart(session, run, label)
    contact = int(run.report.failed_contact)
    where = _place_of(session, contact, label)
    if code == NO_EXTREMUM:
        return SimulationError(
            where,
            "no pair of closest points was found at the start",
            "surfaces with one nearest pair there",
            "start the bodies nearer to each other or away from a symmetric position",
        )
    if code == NO_SIDE:
        return SimulationError(
            where,
            "two curves touch at the start, which has no side of its own",
            "a gap, or a contact that says on which side the second curve lies",
            "give the contact a normal, from the first curve to the second",
        )
    if code == BODY_WITHIN:
        return _within(session, contact, where)
    if session.shared.slots.entry_of(contact) is None:
        return _beyond(session, contact, label)
    settled = session.settle(contact)
    depth, allowed = -float(settled["d"]), session.settings.start_gap * session.system.length
    return SimulationError(
        where,
        f"the bodies interpenetrate at the start by {depth:.3g} m",
        f"at most {float(allowed):.3g} m",
        _way_out(session, contact, depth, settled["normal"]),
    )


def _way_out(session: Session, contact: int, depth: float, normal: Array) -> str:
    """The advice which body to move along the normal, which points from the first body to the second."""
    feature_pair = session.features_of(contact)
    assert feature_pair is not None, "a contact that penetrates is on a feature pair"
    bodies = [session.instance["bodies"][feature_pair[side]] for side in ("f", "o")]
    moving, sign = (bodies[0], 1.0) if bodies[0]["motion"] in ("point", "free") else (bodies[1], -1.0)
    along = ", ".join(f"{sign * float(x) + 0.0:.3g}" for x in normal)
    way = f"move {moving['name']!r} by {depth:.3g} m along ({along}), or check the units: lengths are in m"
    return way + _other_side(session, feature_pair, depth)


def _other_side(session: Session, feature_pair: Mapping[str, Any], depth: float) -> str:
    """The advice on `cavity`, where all of the smaller body may be in the material of the larger one."""
    found = {side: feature_pair[f"shape_{side}"]["bounding_radius"] for side in "of"}
    radii = {side: inf if radius is None else radius for side, radius in found.items()}
    inner, outer = sorted("of", key=radii.__getitem__)
    if depth <= radii[inner]:
        return ""
    kind = session.library.manifest.kinds["shape"][feature_pair[f"shape_{outer}"]["kind"]]
    names = [session.instance["bodies"][feature_pair[side]]["name"] for side in (inner, outer)]
    what = "leave cavity = true out of" if kind["cavity"] else "set cavity = true in"
    return f"; if {names[0]!r} belongs on the other side of the surface of {names[1]!r}, {what} that shape"


def _within(session: Session, contact: int, where: str) -> SimulationError:
    """The error of two bodies of which the smaller one is in the other."""
    slots, entry = session.shared.slots, session.shared.slots.entry_of(contact)
    assert entry is not None, "a body within another one is of a contact with shapes"
    pair = session.instance["pairs"][entry["pair"]]
    first = int(slots.feature_pair.moved[pair["feature_pairs"][0]])
    bodies = slots.bodies_of(contact, first, session.run_arrays["slot_balls"])
    balls = zip(bodies, pair["bounding_balls"], strict=True)
    radii = {body: inf if ball["radius"] is None else ball["radius"] for body, ball in balls}
    inner, outer = (session.instance["bodies"][body]["name"] for body in sorted(radii, key=radii.__getitem__))
    return SimulationError(
        where,
        f"{inner!r} is within {outer!r}, or passes through it, at the start",
        "bodies beside each other",
        f"move {inner!r} out of {outer!r}, or set cavity = true in the shape of {outer!r} if it is hollow",
    )


def _place_of(session: Session, contact: int, label: str) -> str:
    """The place in the scene, as in `scene.toml: contact[1] (contact 'ball-table')`."""
    name, entry = session.contact_name(contact), session.shared.slots.entry_of(contact)
    if entry is None:
        return _place_of_joint(session, name.rsplit(":", 1)[0], label)
    return f"{session.instance['source']}: contact[{entry['pair']}] ({label}contact {name!r})"


def _place_of_joint(session: Session, name: str, label: str) -> str:
    return f"{session.instance['source']}: joint[{session.joints.index(name)}] ({label}joint {name!r})"


def _apart(session: Session, run: Any, label: str) -> SimulationError:
    """The error of the joint whose frames are farthest from closing."""
    return SimulationError(
        _place_of_joint(session, session.joints[run.report.failed_joint], label),
        f"its bodies do not fit together at the start by {float(run.report.joint_error_max):.3g} m: "
        + ", ".join(_frames_apart(session, run.report.failed_joint)),
        f"at most {float(session.settings.start_joint_gap * session.system.length):.3g} m",
        "move them to where the joint holds, or give the joint by one frame in the world at the start",
    )


def _frames_apart(session: Session, index: int) -> Iterator[str]:
    """The distance and angles of the two frames of a joint, in words."""
    joint = session.instance["joints"][index]
    kind = session.library.manifest.kinds["joint"][joint["kind"]]["kind"]
    poses, numbers = session.poses(), np.array(joint["parameters"][:24]).reshape(2, 12)
    placed = [_matrix(poses[joint[side]]) @ _matrix(own) for side, own in zip("ab", numbers, strict=True)]
    relative = np.linalg.inv(placed[0]) @ placed[1]
    yield f"the origins of its frames are {np.linalg.norm(relative[:3, 3]):.3g} m apart"
    if kind in TURNED:
        yield f"their axes are turned by {_degrees((np.trace(relative[:3, :3]) - 1) / 2)}"
    elif kind in ALONG_Z:
        yield f"their z axes are {_degrees(relative[2, 2])} apart"
    elif kind == "universal":
        yield f"x of the first and y of the second are {_degrees(relative[0, 1])} apart, not 90"
    if kind not in ONLY_PLACES:
        yield f"angles count by the length {session.system.length:.3g} m"


def _matrix(pose: Array) -> Array:
    """(4, 4) homogeneous matrix of p and R (column-major)."""
    matrix = np.eye(4)
    matrix[:3, 3], matrix[:3, :3] = pose[:3], pose[3:].reshape(3, 3).T
    return matrix


def _degrees(cosine: float) -> str:
    return f"{np.degrees(np.arccos(np.clip(cosine, -1, 1))):.3g} degrees"


def _beyond(session: Session, contact: int, label: str) -> SimulationError:
    """The error of a start beyond the limit of a joint."""
    joint, end = session.contact_name(contact).rsplit(":", 1)
    return SimulationError(
        _place_of_joint(session, joint, label),
        f"at the start it is past its limit ({end}imum)",
        "a start within the limits",
        "move the bodies or the limit",
    )
