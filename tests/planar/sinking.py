"""How deep a prism is in a table, from nothing but where points of their edges are: no contact is asked."""

from __future__ import annotations

from math import pi

import numpy as np

from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.expression import evaluate
from modelgen.scene.scene_types import Scene, Shape
from tests.oracles.pieces import rotations

Array = np.ndarray

AROUND, ALONG = 600, 100  # points of a loop of edges, and of an edge between two


def outline(shape: Shape) -> Array:
    """(n, 2): the corners of a base, or points of a round one; in m, of a frustum in its radii."""
    numbers = dict(shape.parameters)
    if shape.kind == "box":
        x, y = numbers["x"] / 2, numbers["y"] / 2
        return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    if "x0" in numbers:
        return np.array([[numbers[f"x{k}"], numbers[f"y{k}"]] for k in range((len(numbers) - 1) // 2)])
    angles = np.linspace(0, 2 * pi, AROUND, endpoint=False)
    if shape.profile is None:
        return numbers.get("radius", 1.0) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.array([[evaluate(c, {**numbers, "t": t}) for c in shape.profile.components] for t in angles])


def length_of(shape: Shape) -> float:
    return dict(shape.parameters)["z" if shape.kind == "box" else "length"]


def ends_of(shape: Shape) -> tuple[float, float]:
    """By what the outline is larger at the bottom and at the top."""
    numbers = dict(shape.parameters)
    return numbers.get("radius_bottom", 1.0), numbers.get("radius_top", 1.0)


def edges(shape: Shape) -> Array:
    """(n, 3): points of its edges, in its own axes."""
    corners, half = outline(shape), length_of(shape) / 2
    bottom, top = ends_of(shape)
    following = np.roll(corners, -1, axis=0)
    parts = np.linspace(0, 1, max(1, AROUND // len(corners)), endpoint=False)[:, None, None]
    loop = (corners + parts * (following - corners)).reshape(-1, 2)
    posts = corners[:: max(1, len(corners) // 100)]
    heights = np.linspace(0, 1, ALONG)[:, None, None]
    sides = np.concatenate(
        [
            (bottom + heights * (top - bottom)) * posts,
            np.broadcast_to(half * (2 * heights - 1), (ALONG, len(posts), 1)),
        ],
        axis=2,
    )
    rims = [np.column_stack([k * loop, np.full(len(loop), z)]) for k, z in ((bottom, -half), (top, half))]
    return np.concatenate([*rims, sides.reshape(-1, 3)])


def depths(shape: Shape, points: Array) -> Array:
    """(n,): how deep points in its axes lie within a prism, m, as its flat sides tell; negative outside."""
    corners, half = outline(shape), length_of(shape) / 2
    bottom, top = ends_of(shape)
    size = bottom + (top - bottom) * (points[:, 2] / (2 * half) + 0.5)
    deep = half - np.abs(points[:, 2])
    inner = (deep > 0) & (np.hypot(*points[:, :2].T) < np.abs(corners).max() * 1.5 * np.maximum(size, 0))
    deep = np.where(inner, deep, -1.0)
    at = points[inner, :2] / size[inner, None]
    chord = np.roll(corners, -1, axis=0) - corners
    arm = at[:, None] - corners
    along = np.clip((arm * chord).sum(2) / (chord**2).sum(1), 0, 1)
    away = np.linalg.norm(arm - along[:, :, None] * chord, axis=2).min(1)
    rises = (arm[:, :, 1] < 0) != (arm[:, :, 1] < chord[:, 1])
    crossed = chord[:, 0] * arm[:, :, 1] - chord[:, 1] * arm[:, :, 0]
    left = (rises & ((crossed < 0) == (chord[:, 1] > 0))).sum(1) % 2 == 1
    deep[inner] = np.where(left, np.minimum(away * size[inner], deep[inner]), -1.0)
    return deep


def deepest(scene: Scene, path: Trajectory) -> Array:
    """(samples,): how deep the second body, a prism, and the first, a prism or the plane z = 0, are in each
    other; of each only points of edges are asked, so that it is less than the depth of a thin wedge."""
    (under,), (over,) = (body.shapes for body in scene.bodies)
    moved, turned = edges(over), rotations(path, 1)
    found = np.full(len(path.t), -1.0)
    fixed = None if under.kind == "plane" else edges(under) + np.array(under.pose.position)
    reach = np.linalg.norm(moved, axis=1).max()
    for k, (centre, R) in enumerate(zip(path.p[:, 1], turned, strict=True)):
        world = moved @ R.T + centre
        if fixed is None:
            found[k] = -world[:, 2].min()
            continue
        found[k] = depths(under, world - np.array(under.pose.position)).max()
        near = fixed[np.linalg.norm(fixed - centre, axis=1) < reach]
        if len(near):
            found[k] = max(found[k], depths(over, (near - centre) @ R).max())
    return found
