"""Geoms of a MuJoCo model as shapes of the catalogue."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_compilation import Array, Compiled
from modelgen.importing.name_conversion import Names
from modelgen.importing.scene_writing import vector
from modelgen.importing.welded_bodies import RigidBody, attached, pose_at, pose_in
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Pose

CORNERS = 12  # of a polyhedron, unless more are asked for: features, and their pairs, grow with its square
UNITY = 1e4  # weight of the condition that weights have the sum 1
FILLED = 1e-4  # a mesh that leaves less of its hull free is convex but for its decimals
THIN = 1e-9  # least extent of a hull, against its largest

Shapes = Mapping[int, tuple[RigidBody, dict[str, Any]]]  # by geom, the body and the table of its shape


def shapes(
    source: Compiled, bodies: Mapping[int, RigidBody], used: Collection[int], corners: int, notes: Notes
) -> Shapes:
    """The shapes of geoms that may touch.

    Args:
        used: numbers of these geoms.
        corners: the most corners of a polyhedron.
    """
    model = source.model
    names: dict[str, Names] = {}
    found = {}
    for geom in sorted(used):
        body = bodies[int(model.geom_bodyid[geom])]
        table = _shape(source, geom, corners, notes)
        if table is None:
            continue
        written = source.name("geom", geom).removeprefix(f"{body.name}/")
        name = names.setdefault(body.name, Names()).of(written, str(table["kind"]))
        pose = _placed(source, geom, body, table.pop("pose", Pose()))
        found[geom] = body, {"name": name, **table, **pose_keys(pose)}
    return found


def pose_keys(pose: Pose) -> dict[str, Any]:
    """`position` and `quaternion`, each where it is not that of the outer frame."""
    keys: dict[str, Any] = {}
    if any(vector(pose.position)):
        keys["position"] = vector(pose.position)
    turn = vector(pose.quaternion)
    if any(turn[1:]):
        keys["quaternion"] = turn
    return keys


def _placed(source: Compiled, geom: int, body: RigidBody, own: Pose) -> Pose:
    """The frame of the shape in the axes of its body."""
    model, member = source.model, int(source.model.geom_bodyid[geom])
    local = compose(attached(model.geom_pos[geom], model.geom_quat[geom]), own)
    if body.fixed:
        return body.inside(compose(pose_at(source, member), local))
    return compose(pose_in(source, member, body.members[0]), local)


def _shape(source: Compiled, geom: int, corners: int, notes: Notes) -> dict[str, Any] | None:
    """Kind and keys of a shape, with the `pose` of its frame in that of the geom where it has another."""
    kinds = source.mj.mjtGeom
    kind, size = int(source.model.geom_type[geom]), [float(each) for each in source.model.geom_size[geom]]
    match kind:
        case kinds.mjGEOM_PLANE:
            return {"kind": "plane"}
        case kinds.mjGEOM_SPHERE:
            return {"kind": "sphere", "radius": size[0]}
        case kinds.mjGEOM_CAPSULE:
            return {"kind": "capsule", "radius": size[0], "length": 2 * size[1]}
        case kinds.mjGEOM_CYLINDER:
            return {"kind": "cylinder", "radius": size[0], "length": 2 * size[1]}
        case kinds.mjGEOM_ELLIPSOID:
            return {"kind": "ellipsoid", "semi_axes": vector(size)}
        case kinds.mjGEOM_BOX:
            return {"kind": "box", "size": vector(2 * each for each in size)}
        case kinds.mjGEOM_HFIELD:
            return _height_field(source, geom, notes)
        case kinds.mjGEOM_MESH:
            return _polyhedron(source, geom, corners, notes)
    notes.refuse("surfaces", f"{source.told('geom', geom)} is a signed distance")
    return None


def _height_field(source: Compiled, geom: int, notes: Notes) -> dict[str, Any]:
    model, number = source.model, int(source.model.geom_dataid[geom])
    rows, columns = int(model.hfield_nrow[number]), int(model.hfield_ncol[number])
    first = int(model.hfield_adr[number])
    half_x, half_y, top, _ = (float(each) for each in model.hfield_size[number])
    heights = top * np.reshape(model.hfield_data[first : first + rows * columns], (rows, columns)).T
    notes.approximate(f"{source.told('geom', geom)} is a smooth surface through its {rows * columns} heights")
    return {
        "kind": "height_field",
        "x": vector(np.linspace(-half_x, half_x, columns)),
        "y": vector(np.linspace(-half_y, half_y, rows)),
        "heights": [vector(row) for row in heights],
    }


def _polyhedron(source: Compiled, geom: int, corners: int, notes: Notes) -> dict[str, Any] | None:
    """The convex hull of a mesh, as MuJoCo has it, by its corners."""
    model, number = source.model, int(source.model.geom_dataid[geom])
    first = int(model.mesh_vertadr[number])
    points = np.array(model.mesh_vert[first : first + int(model.mesh_vertnum[number])], dtype=float)
    told = source.told("geom", geom)
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) < 4 or extents[2] <= THIN * extents[0]:
        notes.refuse("meshes", f"{told} has a mesh that spans no volume")
        return None
    hull, missed = hull_corners(points, corners)
    shape = {"kind": "polyhedron", "vertices": [vector(point) for point in hull]}
    first = int(model.mesh_faceadr[number])
    faces = np.array(model.mesh_face[first : first + int(model.mesh_facenum[number])])
    replaced = unlike_its_hull(points, faces)
    if replaced:
        notes.approximate(f"{told} is the convex hull of its mesh, as in MuJoCo: {replaced}")
    if missed:
        cut = f"{len(hull)} corners of its hull: what is cut off reaches {missed:.2g} m beyond them"
        notes.approximate(f"{told} has {cut}")
        replaced = "; ".join([*([replaced] if replaced else []), f"a mesh, by {cut}"])
    return shape | ({"stands_for": replaced} if replaced else {})


def unlike_its_hull(points: Array, faces: Array) -> str:
    """What a mesh of points (n, 3) and triangles (k, 3) is, where its convex hull is something else; empty
    where it fills its hull."""
    from scipy.spatial import ConvexHull  # slow to import, and needed by meshes alone

    corners, number = np.unique(points, axis=0, return_inverse=True)
    faces = number.ravel()[faces]
    edges = np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)])
    one_way, other_way = ({tuple(edge) for edge in each.tolist()} for each in (edges, edges[:, ::-1]))
    if len(one_way) < len(edges) or one_way != other_way:
        return "a mesh that is not closed"
    a, b, c = (corners[faces[:, k]] - corners.mean(axis=0) for k in range(3))
    volume = abs(float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum())) / 6
    share = volume / ConvexHull(points).volume
    return "" if share >= 1 - FILLED else f"a mesh that fills {100 * share:.3g} % of its hull"


def hull_corners(points: Array, most: int) -> tuple[Array, float]:
    """Corners (k, 3) of the hull of points (n, 3), and how far beyond the hull of these a point is, m.

    Where the hull has more than `most` corners, those farthest out are taken one by one, beginning with the
    extreme ones along the principal axes.
    """
    from scipy.spatial import ConvexHull  # slow to import, and needed by meshes alone

    corners = points[ConvexHull(points).vertices]
    if len(corners) <= most:
        return corners, 0.0
    axes = np.linalg.svd(corners - corners.mean(axis=0), full_matrices=False)[2]
    along = corners @ axes.T
    chosen = list(dict.fromkeys([*along.argmax(axis=0).tolist(), *along.argmin(axis=0).tolist()]))
    size = float(np.ptp(corners, axis=0).max())
    while True:
        inner = ConvexHull(corners[chosen])
        outside = (corners @ inner.equations[:, :3].T + inner.equations[:, 3]).max(axis=1)
        if len(chosen) >= most or outside.max() <= THIN * size:
            return corners[chosen], _farthest(corners[outside > 0], corners[chosen], size)
        chosen.append(int(outside.argmax()))


def _farthest(points: Array, corners: Array, size: float) -> float:
    """The largest distance of points (n, 3) from the hull of corners (k, 3), m, by weights of the sum 1."""
    from scipy.optimize import nnls  # slow to import

    matrix = np.vstack([corners.T / size, np.full(len(corners), UNITY)])
    found = (nnls(matrix, np.append(point / size, UNITY))[1] for point in points)
    return size * max(found, default=0.0)
