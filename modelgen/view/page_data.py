"""What a page plays: bodies, poses, contacts and events of a record, as JSON with packed arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from modelgen.geometry.body_meshes import Mesh
from modelgen.model import Model
from modelgen.report.displayed_bodies import Actor, Stage, stage_of
from modelgen.report.run_record import Array, Record, rotate_inverse
from modelgen.report.summary import verdict_line, verdict_title
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Body
from modelgen.view.packing import packed, packed_bytes, packed_indices
from modelgen.view.plots import plots_of, shown_contacts

MOST = 1500  # samples that a page plays


def page_data(
    record: Record, model: Model, tolerance: float, plots: tuple[str, ...] | None
) -> dict[str, Any]:
    """The contents of a page.

    Args:
        record: what `record_of` returned.
        model: what `require` made of its scene.
        tolerance: of the meshes, as a part of the size of each shape.
        plots: titles of the plots that are open at first; those that suit the run where None.
    """
    columns = record.columns
    chosen = slice(None, None, max(1, -(-len(columns["t"]) // MOST)))
    stage = stage_of(record, model, tolerance)
    summary = record.summary
    shown = stage_data(stage, model)
    for index, body in enumerate(shown["bodies"]):
        body["p"] = packed(np.nan_to_num(columns["p"][chosen, index]))
        body["q"] = packed(_known(columns["quaternion"][chosen, index]))
    return {
        **shown,
        "scene": summary["scene"],
        "outcome": _outcome(summary),
        "said": _said(summary),
        "t": packed(columns["t"][chosen]),
        "contacts": [_contact(record, k, chosen) for k in shown_contacts(record)],
        "patches": _patches(record, chosen),
        "events": [
            {"t": each["t"], "kind": each["kind"], "contact": each["contact"], "speed": each["speed"]}
            for each in summary["events"]
        ],
        "plots": plots_of(record, stage.size, chosen, plots),
    }


def stage_data(stage: Stage, model: Model) -> dict[str, Any]:
    """Where a page takes place, and the shapes of the bodies."""
    bodies = zip(stage.actors, model.whole.bodies, model.bodies, strict=True)
    return {
        "centre": stage.centre.tolist(),
        "size": stage.size,
        "follow": stage.follow,
        "deviation": max((actor.mesh.deviation for actor in stage.actors), default=0.0),
        "bodies": [_body(actor, body, np.array(entry.centre_of_mass)) for actor, body, entry in bodies],
    }


def _outcome(summary: dict[str, Any]) -> str:
    reached = f"{summary['outcome']} at t = {summary['t_end']:.6g} s"
    return f"{reached}, {summary['accuracy']}, {verdict_title(summary)}"


def _said(summary: dict[str, Any]) -> str:
    """What there is to say of the accuracy of a run."""
    estimate = summary["estimate"]
    return "; ".join(
        [*([estimate["statement"]] if estimate else []), verdict_line(summary), *summary["warnings"]]
    )


def _body(actor: Actor, body: Body, centre: Array) -> dict[str, Any]:
    return {
        "name": actor.name,
        "moves": actor.moves,
        "bounded": actor.bounded,
        "open": not actor.two_sided,
        "planes": _planes(body, centre),
        **packed_mesh(actor.mesh),
    }


def _planes(body: Body, centre: Array) -> list[list[float]]:
    """Point and normal of the planes of a body, in the axes of its centre of mass: shadows fall on them."""
    found = []
    for shape in body.shapes:
        if shape.kind == "plane":
            normal = rotation_of(shape.pose.quaternion)[:, 2]
            found.append([*(np.array(shape.pose.position) - centre), *(-normal if shape.cavity else normal)])
    return found


def packed_mesh(mesh: Mesh) -> dict[str, Any]:
    """The triangles and lines of a body, as the page takes them."""
    return {
        "vertices": packed(mesh.vertices),
        "normals": packed_bytes(mesh.normals),
        "triangles": packed_indices(mesh.triangles, len(mesh.vertices)),
        "lines": packed(mesh.lines),
    }


def _known(quaternions: Array) -> Array:
    """Quaternions (n, 4); those of bodies whose turning is not known do not turn."""
    return np.where(np.isfinite(quaternions), quaternions, np.array([1.0, 0.0, 0.0, 0.0]))


def contact_of(record: Record, k: int, moving: Sequence[int]) -> dict[str, Any]:
    """A contact without its samples; `moving`: the bodies that move."""
    o, f = (int(body) for body in record.pairs[k])
    side = 1 if f in moving else -1  # forces are those on f, else on o
    return {"name": record.contact_names[k], "o": o, "f": f, "side": side}


def _contact(record: Record, k: int, chosen: slice) -> dict[str, Any]:
    columns = record.columns
    return {
        **contact_of(record, k, record.moving),
        "force": packed(columns["force"][chosen, k]),
        "gap": packed(columns["gap"][chosen, k]),
        "point": packed(columns["points_f"][chosen, k]),
        "point_o": packed(columns["points_o"][chosen, k]),
        "normal": packed(columns["normals"][chosen, k]),
        "friction": packed(columns["friction"][chosen, k]),
        "on_o": packed(_loaded(record, k, "o")[chosen]),
        "on_f": packed(_loaded(record, k, "f")[chosen]),
    }


def _loaded(record: Record, k: int, side: str) -> Array:
    """The contact curve on one side where the contact carries force, NaN elsewhere."""
    curve = record.contact_curve(k, side)
    return np.where((record.columns["force"][:, k] > 0)[:, None], curve, np.nan)


def _in_axes(record: Record, body: int, points: Array) -> Array:
    """Points of the world (n, 3) in the axes of a body's centre of mass at each sample."""
    columns = record.columns
    return rotate_inverse(columns["quaternion"][:, body], points - columns["p"][:, body])


def patch_of(record: Record, patch: int, moving: Sequence[int]) -> dict[str, Any]:
    """A patch without its samples: outline and axes of the second face, with the friction on it."""
    body, axes = int(record.faces[f"{patch}_body"][0]), record.faces[f"{patch}_axes"]
    return {
        "name": record.patch_names[patch],
        "outline": packed(record.faces[f"{patch}_outline"]),
        "body": body,
        "other": int(record.faces.get(f"{patch}_other", [-1])[0]),
        "side": 1 if body in moving else -1,
        "axes": axes.tolist(),
    }


def _patches(record: Record, chosen: slice) -> list[dict[str, Any]]:
    """Faces that rest, with resultant, centre of pressure and friction."""
    found = []
    for patch in record.rested:
        mine = record.columns["patch"] == patch
        force = np.where(mine, record.columns["patch_force"], 0.0).sum(axis=1)
        point = np.where(mine[..., None], record.columns["patch_point"], 0.0).sum(axis=1)
        point = np.where(mine.any(axis=1, keepdims=True), point, np.nan)
        friction = np.where(mine[..., None], record.columns["patch_friction"], 0.0).sum(axis=1)
        shown = patch_of(record, patch, record.moving)
        axes, other = np.array(shown["axes"]), shown["other"]
        found.append(
            {
                **shown,
                "force": packed(force[chosen]),
                "point": packed(point[chosen]),
                "friction": packed(friction[chosen]),
                "curve": packed((axes[:3] + record.pressure_curve(patch) @ axes[3:9].reshape(2, 3))[chosen]),
                "on_other": packed(_in_axes(record, other, point)[chosen]) if other >= 0 else "",
            }
        )
    return found
