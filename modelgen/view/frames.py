"""What a page plays: bodies, poses, contacts, events and curves of a record, as JSON with packed arrays."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.model import Model
from modelgen.report.run_record import Array, Record
from modelgen.scene.scene_types import Body
from modelgen.geometry.body_meshes import Mesh, body_mesh

REACH = 1.6  # of unbounded surfaces, against what the moving bodies reach
MOST = 1500  # samples that a page plays
NEAR, FAR = (
    3.0,
    12.0,
)  # of the picture and of all motion, against the largest moving body, where it is followed
UNBOUNDED = ("plane", "halfspace", "line")
CURVES = 12  # plotted curves, at most, of one kind


def page_data(record: Record, model: Model, tolerance: float) -> dict[str, Any]:
    """The contents of a page.

    Args:
        record: what `record_of` returned.
        model: what `require` made of its scene.
        tolerance: of the meshes, as a part of the size of each shape.
    """
    columns = record.columns
    every = max(1, -(-len(columns["t"]) // MOST))
    chosen = slice(None, None, every)
    space = _space(record, model)
    meshes = [
        body_mesh(body, entry.centre_of_mass, REACH * space.reach, tolerance)
        for body, entry in zip(model.whole.bodies, model.bodies, strict=True)
    ]
    return {
        "scene": record.summary["scene"],
        "outcome": record.summary["outcome"],
        "centre": space.centre.tolist(),
        "size": space.size,
        "follow": space.follow,
        "t": _packed(columns["t"][chosen]),
        "bodies": [
            {
                "name": name,
                "moves": index in record.moving,
                "followed": index in record.moving and _is_bounded(model.whole.bodies[index]),
                **_packed_mesh(_with_levers(mesh, model, index)),
                "p": _packed(np.nan_to_num(columns["p"][chosen, index])),
                "q": _packed(_known(columns["quaternion"][chosen, index])),
            }
            for index, (name, mesh) in enumerate(zip(record.body_names, meshes, strict=True))
        ],
        "contacts": [_contact(record, k, chosen) for k in _shown_contacts(record)],
        "patches": _patches(record, chosen),
        "events": [
            {"t": event["t"], "kind": event["kind"], "contact": event["contact"]}
            for event in record.summary["events"]
        ],
        "plots": _plots(record, chosen),
    }


def _packed(values: Array) -> str:
    """Numbers as base64 of 32-bit floats, little-endian."""
    return b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()


def _packed_mesh(mesh: Mesh) -> dict[str, str]:
    corners = np.ascontiguousarray(mesh.triangles, dtype="<u4").tobytes()
    return {
        "vertices": _packed(mesh.vertices),
        "normals": _packed(mesh.normals),
        "triangles": b64encode(corners).decode(),
        "lines": _packed(mesh.lines),
    }


def _known(quaternions: Array) -> Array:
    """Quaternions (n, 4); those of bodies whose turning is not known do not turn."""
    return np.where(np.isfinite(quaternions), quaternions, np.array([1.0, 0.0, 0.0, 0.0]))


@dataclass(frozen=True, slots=True)
class _Space:
    """Where a run takes place."""

    centre: Array  # (3,) m
    size: float  # half the size of the picture, m
    reach: float  # half the size of what all motion covers, m
    follow: bool  # the picture moves with the bodies


def _space(record: Record, model: Model) -> _Space:
    """The space in which bounded bodies move; those that go far beyond their own size are followed."""
    points, radii = [], [1e-6]
    for index, body in enumerate(model.whole.bodies):
        bounded = _is_bounded(body)
        radius = _radius(body, model.bodies[index].centre_of_mass) if bounded else 0.0
        path = record.columns["p"][:, index]
        path = path[np.isfinite(path).all(axis=1)]
        if not len(path) or not (bounded or index in record.moving):
            continue
        points += [path - radius, path + radius]
        if index in record.moving and bounded:
            radii.append(radius)
    if not points:
        return _Space(np.zeros(3), 1.0, 1.0, False)
    all_points = np.concatenate(points)
    low, high = all_points.min(axis=0), all_points.max(axis=0)
    reach = max(float((high - low).max()) / 2, 1e-6)
    near = NEAR * max(radii)
    follow = max(radii) > 1e-6 and reach > FAR * max(radii)
    return _Space((low + high) / 2, near if follow else reach, reach, follow)


def _is_bounded(body: Body) -> bool:
    return all(shape.kind not in UNBOUNDED for shape in body.shapes)


def _radius(body: Body, centre: Sequence[float]) -> float:
    mesh = body_mesh(body, centre, 1e-3, 0.1)
    own = np.concatenate([mesh.vertices, mesh.lines.reshape(-1, 3)])
    return float(np.linalg.norm(own, axis=1).max(initial=0.0))


def _with_levers(mesh: Mesh, model: Model, index: int) -> Mesh:
    """A body without shapes is drawn as lines from its centre of mass to its joints."""
    if not mesh.is_empty:
        return mesh
    centre = np.array(model.bodies[index].centre_of_mass)
    ends = [
        np.array(frame.position) - centre
        for joint in model.joints
        for body, frame in zip((joint.a, joint.b), joint.frames, strict=True)
        if body == index
    ]
    lines = np.array([[np.zeros(3), end] for end in ends if np.linalg.norm(end) > 0]).reshape(-1, 2, 3)
    return Mesh(mesh.vertices, mesh.normals, mesh.triangles, lines)


def _shown_contacts(record: Record) -> list[int]:
    """Contacts with shapes that came near to touching."""
    count = len(record.pairs)
    force = record.columns["force"][:, :count]
    struck = {event["contact"] for event in record.summary["events"]}
    return [k for k in range(count) if force[:, k].any() or record.contact_names[k] in struck]


def _contact(record: Record, k: int, chosen: slice) -> dict[str, Any]:
    columns = record.columns
    return {
        "name": record.contact_names[k],
        "o": int(record.pairs[k, 0]),
        "f": int(record.pairs[k, 1]),
        "side": 1 if int(record.pairs[k, 1]) in record.moving else -1,  # forces are those on f, else on o
        "force": _packed(columns["force"][chosen, k]),
        "gap": _packed(columns["gap"][chosen, k]),
        "point": _packed(columns["points_f"][chosen, k]),
        "normal": _packed(columns["normals"][chosen, k]),
        "friction": _packed(columns["friction"][chosen, k]),
        "on_o": _packed(record.contact_curve(k, "o")[chosen]),
        "on_f": _packed(record.contact_curve(k, "f")[chosen]),
    }


def _patches(record: Record, chosen: slice) -> list[dict[str, Any]]:
    """Resultant and centre of pressure of faces that rest, with the normal out of the first face."""
    found = []
    for patch in record.rested:
        mine = record.columns["patch"][chosen] == patch
        force = np.where(mine, record.columns["patch_force"][chosen], 0.0).sum(axis=1)
        point = np.where(mine[..., None], record.columns["patch_point"][chosen], 0.0).sum(axis=1)
        found.append(
            {
                "name": record.patch_names[patch],
                "force": _packed(force),
                "point": _packed(np.where(force[:, None] != 0, point, np.nan)),
                "outline": _packed(record.faces[f"{patch}_outline"]),
                "body": int(record.faces[f"{patch}_body"][0]),
                "axes": record.faces[f"{patch}_axes"].tolist(),
            }
        )
    return found


def _plots(record: Record, chosen: slice) -> list[dict[str, Any]]:
    """Curves over time: energy, normal forces, gaps, joint coordinates, sensors, speeds."""
    columns = record.columns
    shown = _shown_contacts(record)
    contact_names = [record.contact_names[k] for k in shown]
    groups: list[tuple[str, str, Sequence[str], list[Array]]] = [
        ("energy", "J", ("energy", "work"), [columns["energy"], columns["work"]]),
        (
            "speed", "m/s", [record.body_names[i] for i in record.moving],
            [np.linalg.norm(columns["v"][:, i], axis=1) for i in record.moving],
        ),
        ("normal force", "N", contact_names, [columns["force"][:, k] for k in shown]),
        ("gap", "m", contact_names, [columns["gap"][:, k] for k in shown]),
        ("joint coordinates", "rad, m", record.coordinate_names, list(columns["coordinates"].T)),
        ("sensors", "SI", record.sensor_names, list(columns["sensors"].T)),
    ]  # fmt: skip
    return [
        {
            "title": title,
            "unit": unit,
            "names": list(names)[:CURVES],
            "curves": [_packed(curve[chosen]) for curve in curves[:CURVES]],
        }
        for title, unit, names, curves in groups
        if curves
    ]
