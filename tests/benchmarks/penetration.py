"""How deep bodies lie in each other, by geometry of its own: one referee for every program.

The depth of two convex solids that overlap is the shortest way out: the least of
f(n) = h_a(n) + h_b(-n) - n.d over unit directions n, where h are support functions about the centres and d
leads from a to b. Planes, spheres and capsules have closed forms, boxes the axes that can separate them,
ellipsoids Newton's method on the sphere of directions. Each function takes many pairs at once; `Referee`
takes the shapes and pairs of a scene.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from modelgen.benchmark.peers.scene_description import numbers
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Scene, Shape

Array = Any  # numpy's
SEARCHES = 60  # halvings of an interval, Newton steps
FLAT = 1e-9  # least curvature of f, of the sizes of both solids, that Newton's method divides by
SETTLED = 1e-9  # a turn, rad, below which f changes less than by rounding
PARALLEL = 1e-12  # square of the cross product of two edges, below which it is no axis
STARTED = 1e-12  # m, below which a direction has no length


class Solids(NamedTuple):
    """Shapes of one kind in the world: planes z = 0 with exterior +z, capsules along z."""

    centre: Array  # (n, 3) m
    turned: Array  # (n, 3, 3) rotation matrices
    size: Array  # (n, k) m: radius; semi-axes; radius and half the straight length; half the edges

    def taken(self, these: Array) -> Solids:
        return Solids(self.centre[these], self.turned[these], self.size[these])


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("...i,...i->...", a, b)


def _into(turned: Array, v: Array) -> Array:
    """Vectors (n, 3) of the world in the axes of solids."""
    return np.einsum("nji,nj->ni", turned, v)


def _ends(capsules: Solids) -> tuple[Array, Array]:
    """Both ends of the axis of each capsule, (n, 3)."""
    half = capsules.size[:, 1:2] * capsules.turned[:, :, 2]
    return capsules.centre - half, capsules.centre + half


SUPPORT: dict[str, Callable[[Solids, Array], Array]] = {  # (n,) h of directions (n, 3)
    "sphere": lambda solids, n: solids.size[:, 0] * np.linalg.norm(n, axis=1),
    "ellipsoid": lambda solids, n: np.linalg.norm(solids.size * _into(solids.turned, n), axis=1),
    "capsule": lambda solids, n: (
        solids.size[:, 0] * np.linalg.norm(n, axis=1)
        + solids.size[:, 1] * np.abs(_dot(solids.turned[:, :, 2], n))
    ),
    "box": lambda solids, n: _dot(solids.size, np.abs(_into(solids.turned, n))),
}
REACH: dict[str, Callable[[Array], Array]] = {  # (n,) radius of a ball around each
    "plane": lambda size: np.full(len(size), np.inf),
    "sphere": lambda size: size[:, 0],
    "ellipsoid": lambda size: size.max(axis=1),
    "capsule": lambda size: size.sum(axis=1),
    "box": lambda size: np.linalg.norm(size, axis=1),
}


def on_plane(kind: str, planes: Solids, others: Solids) -> Array:
    """Depth below a plane; where negative, minus the distance."""
    up = planes.turned[:, :, 2]
    return SUPPORT[kind](others, -up) - _dot(up, others.centre - planes.centre)


def sphere_sphere(a: Solids, b: Solids) -> Array:
    return a.size[:, 0] + b.size[:, 0] - np.linalg.norm(b.centre - a.centre, axis=1)


def sphere_capsule(a: Solids, b: Solids) -> Array:
    along = b.turned[:, :, 2]
    way = a.centre - b.centre
    at = np.clip(_dot(way, along), -b.size[:, 1], b.size[:, 1])
    return a.size[:, 0] + b.size[:, 0] - np.linalg.norm(way - at[:, None] * along, axis=1)


def capsule_capsule(a: Solids, b: Solids) -> Array:
    """Of the points s and t along both axes, those nearest: inside both lengths, or at an end of one."""
    u, v, way = a.turned[:, :, 2], b.turned[:, :, 2], a.centre - b.centre
    long_a, long_b = a.size[:, 1], b.size[:, 1]
    across, on_u, on_v = _dot(u, v), _dot(u, way), _dot(v, way)
    sine = 1.0 - across**2
    inner = np.where(sine > PARALLEL, (across * on_v - on_u) / np.maximum(sine, PARALLEL), 0.0)
    nearest = np.full(len(way), np.inf)
    for s in (np.clip(inner, -long_a, long_a), -long_a, long_a):
        t = np.clip(across * s + on_v, -long_b, long_b)
        s = np.clip(across * t - on_u, -long_a, long_a)
        gap = way + s[:, None] * u - t[:, None] * v
        nearest = np.minimum(nearest, np.linalg.norm(gap, axis=1))
    return a.size[:, 0] + b.size[:, 0] - nearest


def box_box(a: Solids, b: Solids) -> Array:
    """The least overlap along the normals of faces and the cross products of edges; where negative, boxes
    are at least so far apart. Boxes without width along an axis are rectangles and segments."""
    d = b.centre - a.centre
    best = np.full(len(d), np.inf)
    edges_a, edges_b = np.swapaxes(a.turned, 1, 2), np.swapaxes(b.turned, 1, 2)
    crossed = np.cross(edges_a[:, :, None], edges_b[:, None]).reshape(-1, 9, 3)
    for axes in (edges_a, edges_b, crossed):
        for k in range(axes.shape[1]):
            square = _dot(axes[:, k], axes[:, k])
            n = axes[:, k] / np.sqrt(np.maximum(square, PARALLEL))[:, None]
            overlap = SUPPORT["box"](a, n) + SUPPORT["box"](b, n) - np.abs(_dot(n, d))
            best = np.where(square > PARALLEL, np.minimum(best, overlap), best)
    return best


def sphere_box(a: Solids, b: Solids) -> Array:
    at = _into(b.turned, a.centre - b.centre)
    outside = np.linalg.norm(at - np.clip(at, -b.size, b.size), axis=1)
    inside = (b.size - np.abs(at)).min(axis=1)
    return a.size[:, 0] + np.where(outside > 0, -outside, inside)


def capsule_box(a: Solids, b: Solids) -> Array:
    """The axis of the capsule beside the box: their distance, whose square is convex along the axis, or
    where they meet the depth of the axis."""
    first, last = (_into(b.turned, end - b.centre) for end in _ends(a))
    along = last - first
    low, high = np.zeros(len(first)), np.ones(len(first))
    for _ in range(SEARCHES):
        middle = (low + high) / 2
        at = first + middle[:, None] * along
        rises = _dot(at - np.clip(at, -b.size, b.size), along) > 0
        low, high = np.where(rises, low, middle), np.where(rises, middle, high)
    ends = [first + part[:, None] * along for part in (low, high)]
    apart = np.min([np.linalg.norm(at - np.clip(at, -b.size, b.size), axis=1) for at in ends], axis=0)
    axis = Solids(a.centre, a.turned, np.column_stack([0 * a.size[:, 1], 0 * a.size[:, 1], a.size[:, 1]]))
    return a.size[:, 0] + np.where(apart > 0, -apart, np.maximum(box_box(axis, b), 0.0))


def ellipsoid_ellipsoid(a: Solids, b: Solids) -> Array:
    """The least f(n), from the direction of the centres and from the axes of both. Where f is negative in the
    direction of the centres they are apart, at least that far."""
    d = b.centre - a.centre
    found = _f(a, b, d, _signed(d, d, a.turned[:, :, 2]))
    near = found >= 0
    a, b, d = a.taken(near), b.taken(near), d[near]
    starts = [d, *np.moveaxis(a.turned, 2, 0), *np.moveaxis(b.turned, 2, 0)]
    found[near] = np.min([_descended(a, b, d, start) for start in starts], axis=0)
    return found


def _signed(start: Array, d: Array, otherwise: Array) -> Array:
    """Unit directions (n, 3) of starts, towards d; where they have no length, others."""
    n = start * np.where(_dot(start, d) < 0, -1.0, 1.0)[:, None]
    length = np.linalg.norm(n, axis=1, keepdims=True)
    return np.where(length > STARTED, n / np.maximum(length, STARTED), otherwise)


def _f(a: Solids, b: Solids, d: Array, n: Array) -> Array:
    return SUPPORT["ellipsoid"](a, n) + SUPPORT["ellipsoid"](b, n) - _dot(n, d)


def _descended(a: Solids, b: Solids, d: Array, start: Array) -> Array:
    """f at the end of Newton's method on the sphere of directions, from a start."""
    n = _signed(start, d, a.turned[:, :, 2])
    squares = [np.einsum("nij,nj,nkj->nik", each.turned, each.size**2, each.turned) for each in (a, b)]
    value, least = _f(a, b, d, n), FLAT * (a.size + b.size).sum(axis=1)
    for _ in range(SEARCHES):
        gradient, curved = -d, np.zeros((len(d), 3, 3))
        for square in squares:
            mapped = np.einsum("nij,nj->ni", square, n)
            h = np.sqrt(_dot(mapped, n))
            gradient = gradient + mapped / h[:, None]
            curved += (
                square / h[:, None, None] - np.einsum("ni,nj->nij", mapped, mapped) / h[:, None, None] ** 3
            )
        aside = np.linalg.svd(n[:, None])[2][:, 1:]  # (n, 2, 3): both directions across n
        slope = np.einsum("nij,nj->ni", aside, gradient)
        bent = np.einsum("nij,njk,nlk->nil", aside, curved, aside) - value[:, None, None] * np.eye(2)
        sizes, axes = np.linalg.eigh(bent)
        sizes = np.maximum(np.abs(sizes), least[:, None])
        step = -np.einsum("nij,nj->ni", axes, np.einsum("nij,ni->nj", axes, slope) / sizes)
        way, part = np.einsum("ni,nij->nj", step, aside), np.ones(len(d))
        turn = np.linalg.norm(step, axis=1)
        if not (turn > SETTLED).any():
            break
        moved, found = n, value
        for _ in range(SEARCHES):
            moved = n + part[:, None] * way
            moved /= np.linalg.norm(moved, axis=1, keepdims=True)
            found = _f(a, b, d, moved)
            worse = (found > value) & (part * turn > SETTLED)
            if not worse.any():
                break
            part = np.where(worse, part / 2, part)
        better = found < value
        if not better.any():
            break
        n, value = np.where(better[:, None], moved, n), np.where(better, found, value)
    return value


DEPTH: dict[tuple[str, str], Callable[[Solids, Solids], Array]] = {
    **{("plane", kind): partial(on_plane, kind) for kind in SUPPORT},
    ("sphere", "sphere"): sphere_sphere,
    ("sphere", "capsule"): sphere_capsule,
    ("sphere", "box"): sphere_box,
    ("capsule", "capsule"): capsule_capsule,
    ("capsule", "box"): capsule_box,
    ("box", "box"): box_box,
    ("ellipsoid", "ellipsoid"): ellipsoid_ellipsoid,
}


def size_of(shape: Shape) -> list[float]:
    """The size of a shape as `Solids` has it, filled up with zeros."""
    given = [*numbers(shape).values()]
    if shape.kind == "capsule":
        given = [given[0], given[1] / 2]
    if shape.kind == "box":
        given = [edge / 2 for edge in given]
    return [*given, 0.0, 0.0, 0.0][:3]


class Referee:
    """The pairs of shapes that a scene lists, wherever its bodies are."""

    def __init__(self, scene: Scene) -> None:
        placed = [(k, shape) for k, body in enumerate(scene.bodies) for shape in body.shapes]
        row = {(scene.bodies[k].name, shape.name): at for at, (k, shape) in enumerate(placed)}
        self._body = np.array([k for k, _ in placed])
        self._at = np.array([shape.pose.position for _, shape in placed])
        self._turned = np.array([rotation_of(shape.pose.quaternion) for _, shape in placed])
        self._size = np.array([size_of(shape) for _, shape in placed])
        kinds = [shape.kind for _, shape in placed]
        self._reach = np.array(
            [REACH[kind](size[None])[0] for kind, size in zip(kinds, self._size, strict=True)]
        )
        order = [*REACH]
        listed: dict[tuple[str, str], list[tuple[int, int]]] = {}
        for pair in scene.contacts:
            a, b = sorted((row[partner] for partner in pair.between), key=lambda at: order.index(kinds[at]))
            listed.setdefault((kinds[a], kinds[b]), []).append((a, b))
        missing = listed.keys() - DEPTH.keys()
        assert not missing, f"no depth of {missing}"
        self._pairs = {of: np.array(pairs) for of, pairs in listed.items()}

    def depth(self, p: Array, turned: Array) -> float:
        """The deepest penetration, m, of bodies whose frames, as the scene has them, lie at p (nb, 3) and are
        turned by (nb, 3, 3); 0: none."""
        at = p[self._body] + np.einsum("nij,nj->ni", turned[self._body], self._at)
        shapes = Solids(at, turned[self._body] @ self._turned, self._size)
        deepest = 0.0
        for of, pairs in self._pairs.items():
            a, b = pairs.T
            near = np.linalg.norm(at[a] - at[b], axis=1) < self._reach[a] + self._reach[b]
            if near.any():
                deepest = max(deepest, float(DEPTH[of](shapes.taken(a[near]), shapes.taken(b[near])).max()))
        return deepest
