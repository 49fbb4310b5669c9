"""The shapes that no contact of the scene pairs with each other, as plain values for the manifest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from modelgen.assembly.masses import pose_numbers
from modelgen.geometry.extent import bounding_ball
from modelgen.geometry.shape_samples import samples_of
from modelgen.geometry.solid_terms import about_terms_of, is_thin
from modelgen.model import Model
from modelgen.scene.contact_groups import all_pairs
from modelgen.scene.scene_types import Body, Shape


def unlisted_of(model: Model) -> dict[str, Any]:
    """The shapes that some other body's shape may pass through unseen, and the pairs that are excepted.

    Empty where every two shapes of bodies of which one can move are listed, or their bodies are joined.
    """
    scene = model.scene
    of_body = [(k, shape) for k, body in enumerate(scene.bodies) for shape in body.shapes]
    names = [(scene.bodies[k].name, shape.name) for k, shape in of_body]
    index = {name: k for k, name in enumerate(names)}
    listed = {_ordered(*(index[partner] for partner in pair.between)) for pair in scene.contacts}
    bodies = {body.name: k for k, body in enumerate(scene.bodies)}
    joined = {_ordered(*(bodies[name] for name in joint.between)) for joint in scene.joints}
    owner = np.array([body for body, _ in of_body], dtype=int)
    open_to = _may_meet(scene.bodies)[owner[:, None], owner]
    for pool in scene.pools:
        one, other = ([index[each] for each in scene.classes[k]] for k in pool.classes)
        open_to[np.ix_(one, other)] = open_to[np.ix_(other, one)] = False
    for i, j in listed:
        open_to[i, j] = open_to[j, i] = False
    for a, b in joined:
        one, other = owner == a, owner == b
        open_to[np.ix_(one, other)] = open_to[np.ix_(other, one)] = False
    involved = {int(owner[k]) for k in np.flatnonzero(open_to.any(axis=1))}
    kept = [k for k, (body, _) in enumerate(of_body) if body in involved]
    place = {k: at for at, k in enumerate(kept)}
    pooled = (
        {_ordered(*(index[each] for each in pair.between)) for pair in all_pairs(scene)} if kept else set()
    )
    return {
        "shapes": [shape_entry(model, k, *of_body[k]) for k in kept],
        "listed": [[place[i], place[j]] for i, j in sorted(listed | pooled) if i in place and j in place],
        "joined": [list(pair) for pair in sorted(joined) if set(pair) <= involved],
    }


def _ordered(a: int, b: int) -> tuple[int, int]:
    return min(a, b), max(a, b)


def _may_meet(bodies: Sequence[Body]) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """(n, n) whether two bodies are different and one of them can move."""
    moves = np.array([body.motion == "dynamic" for body in bodies], dtype=bool)
    met: np.ndarray[Any, np.dtype[np.bool_]] = (moves[:, None] | moves) & ~np.eye(len(bodies), dtype=bool)
    return met


def placed_entry(model: Model, body: int, shape: Shape) -> dict[str, Any]:
    """Where one shape is, and the ball around it."""
    centre, radius = bounding_ball(shape)
    return {
        "body": body,
        "name": shape.name,
        "alone": len(model.scene.bodies[body].shapes) == 1,
        "cavity": shape.cavity,
        "placement": list(pose_numbers(shape.pose, model.bodies[body].centre_of_mass)),
        "centre": list(centre),
        "radius": float(radius) if np.isfinite(radius) else None,
        "thin": is_thin(shape),
    }


def shape_entry(model: Model, number: int, body: int, shape: Shape) -> dict[str, Any]:
    """One shape: its number among the solids of the manifest, which are all shapes, and samples of its
    surface where these have no terms of it."""
    entry = {**placed_entry(model, body, shape), "solid": number}
    if about_terms_of(shape):
        return {**entry, "kind": "terms"}
    samples = samples_of(shape)
    if samples is None:
        return {**entry, "kind": "unknown", "parameters": []}
    return {
        **entry,
        "kind": "sampled",
        "parameters": [samples.spacing],
        "points": samples.points.ravel().tolist(),
        "normals": samples.normals.ravel().tolist(),
    }
