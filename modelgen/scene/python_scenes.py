"""Scenes written in Python, through the same tables and checks as scene files.

Keyword arguments are the keys of the scene format:

>>> egg = dynamic("egg", ellipsoid(0.03, 0.02, 0.02), density=1000.0, position=[0.0, 0.0, 0.02])
>>> table = fixed("table", plane())
>>> drop = scene("drop", [egg, table], contact=[{"between": ["egg", "table"], "restitution": 0.5}])
>>> drop.contacts[0].between
(('egg', 'ellipsoid'), ('table', 'plane'))
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from modelgen.scene.scene_format import BODY, SCENE, SCENE_NAME, SHAPE
from modelgen.scene.scene_from_tables import place_of, scene_from_bodies, scene_from_tables
from modelgen.scene.scene_types import Body, Scene, Shape
from modelgen.scene.shapes_and_bodies import body_of, read_body, read_shape
from modelgen.scene.source_location import Place

SOURCE = "<python>"
Pair = Sequence[float]


def shape(kind: str, **keys: object) -> Shape:
    """A shape of the catalogue, a chart or a curve; keys as in the scene format. Raises SceneError."""
    place = Place(SOURCE, f"shape {kind}")
    return read_shape(SHAPE.read({"kind": kind, **keys}, place), place)


def plane(**keys: object) -> Shape:
    """The plane z = 0 with exterior +z."""
    return shape("plane", **keys)


def sphere(radius: float, **keys: object) -> Shape:
    """A sphere; `radius` in m."""
    return shape("sphere", radius=radius, **keys)


def ellipsoid(a: float, b: float, c: float, **keys: object) -> Shape:
    """An ellipsoid; semi-axes in m."""
    return shape("ellipsoid", semi_axes=[a, b, c], **keys)


def torus(major: float, minor: float, **keys: object) -> Shape:
    """A torus about z; radii in m, `minor` of the tube."""
    return shape("torus", major=major, minor=minor, **keys)


def cylinder(radius: float, length: float | None = None, **keys: object) -> Shape:
    """A cylinder about z, infinite without a length, else centred and with ends; in m."""
    ends = {} if length is None else {"length": length}
    return shape("cylinder", radius=radius, **ends, **keys)


def cone(half_angle: float, **keys: object) -> Shape:
    """An infinite cone about z below its apex at the origin; `half_angle` in rad."""
    return shape("cone", half_angle=half_angle, **keys)


def paraboloid(rho_x: float, rho_y: float, **keys: object) -> Shape:
    """z = x^2/(2 rho_x) + y^2/(2 rho_y) with exterior +z; radii of curvature in m."""
    return shape("paraboloid", radii=[rho_x, rho_y], **keys)


def superellipsoid(a: float, b: float, c: float, p: float, q: float, **keys: object) -> Shape:
    """(|x/a|^p + |y/b|^p)^(q/p) + |z/c|^q = 1; semi-axes in m."""
    return shape("superellipsoid", semi_axes=[a, b, c], exponents=[p, q], **keys)


def chart(x: str, y: str, z: str, *, domain: Sequence[Pair], **keys: object) -> Shape:
    """A surface of your own: x, y, z in m as expressions of u, v and `parameters`.

    The exterior is the side of d(x,y,z)/du x d(x,y,z)/dv.
    """
    return shape("chart", x=x, y=y, z=z, domain=domain, **keys)


def line(**keys: object) -> Shape:
    """The z axis as a curve without ends."""
    return shape("line", **keys)


def segment(length: float, **keys: object) -> Shape:
    """The z axis from -length/2 to length/2; `length` in m."""
    return shape("segment", length=length, **keys)


def edge(length: float, **keys: object) -> Shape:
    """The x axis from -length/2 to length/2; `length` in m."""
    return shape("edge", length=length, **keys)


def circle(radius: float, **keys: object) -> Shape:
    """The curve (radius cos t, radius sin t, 0); `radius` in m."""
    return shape("circle", radius=radius, **keys)


def ellipse_curve(a: float, b: float, **keys: object) -> Shape:
    """The curve (a cos t, b sin t, 0); semi-axes in m."""
    return shape("ellipse_curve", semi_axes=[a, b], **keys)


def helix(radius: float, lead: float, **keys: object) -> Shape:
    """The curve (radius cos t, radius sin t, lead t/(2 pi)); in m, `lead` the rise in a turn."""
    return shape("helix", radius=radius, lead=lead, **keys)


def curve(x: str, y: str, z: str, *, domain: Pair, **keys: object) -> Shape:
    """A curve of your own: x, y, z in m as expressions of t and `parameters`."""
    return shape("curve", x=x, y=y, z=z, domain=domain, **keys)


def point(x: float = 0.0, y: float = 0.0, z: float = 0.0, **keys: object) -> Shape:
    """A point by itself; coordinates in the shape frame, m."""
    return shape("point", at=[x, y, z], **keys)


def revolution(r: str, z: str, *, domain: Pair, **keys: object) -> Shape:
    """A surface of revolution about z: r, z in m as expressions of t and `parameters`.

    The exterior is the outside of what the profile encloses, or the side away from the axis.
    """
    return shape("revolution", r=r, z=z, domain=domain, **keys)


def profile_wall(points: Sequence[Pair], length: float, **keys: object) -> Shape:
    """An open profile through points [x, y] in m along z, centred, without ends; exterior on their right."""
    return shape("profile_wall", points=points, length=length, **keys)


def bspline(points: Sequence[Sequence[Sequence[float]]], **keys: object) -> Shape:
    """A B-spline surface through a control net [u][v][xyz] in m, cubic unless `degree` is given."""
    return shape("bspline", points=points, **keys)


def height_field(
    x: Sequence[float], y: Sequence[float], heights: Sequence[Sequence[float]], **keys: object
) -> Shape:
    """The bicubic spline through heights [x][y] in m over a grid; exterior +z."""
    return shape("height_field", x=x, y=y, heights=heights, **keys)


def bspline_curve(points: Sequence[Sequence[float]], **keys: object) -> Shape:
    """A B-spline curve with control points in m, cubic unless `degree` is given."""
    return shape("bspline_curve", points=points, **keys)


def polyline(points: Sequence[Sequence[float]], radius: float, **keys: object) -> Shape:
    """Straight pieces between points in m, corners rounded with `radius`."""
    return shape("polyline", points=points, radius=radius, **keys)


def surface_line(surface: Mapping[str, object], **keys: object) -> Shape:
    """A line u = ... or v = ... of a surface, which is written as its table in a scene file."""
    return shape("surface_line", surface=surface, **keys)


def box(x: float, y: float, z: float, **keys: object) -> Shape:
    """A box centred at the origin; its edges in m."""
    return shape("box", size=[x, y, z], **keys)


def disc(radius: float, **keys: object) -> Shape:
    """A flat disc in z = 0 without thickness; `radius` in m."""
    return shape("disc", radius=radius, **keys)


def capsule(radius: float, length: float, **keys: object) -> Shape:
    """A cylinder about z between two half spheres, centred; `length` of the straight part, m."""
    return shape("capsule", radius=radius, length=length, **keys)


def tube(radius: float, bore: float, length: float, **keys: object) -> Shape:
    """A cylinder about z with a bore of radius `bore`, centred; lengths in m."""
    return shape("tube", radius=radius, bore=bore, length=length, **keys)


def frustum(radius_bottom: float, radius_top: float, length: float, **keys: object) -> Shape:
    """A truncated cone about z, centred; lengths in m."""
    return shape("frustum", radius_bottom=radius_bottom, radius_top=radius_top, length=length, **keys)


def dome(radius: float, length: float, **keys: object) -> Shape:
    """The part of a ball above z = 0 with its top at `length`, half of it if that is `radius`; in m."""
    return shape("dome", radius=radius, length=length, **keys)


def half_torus(major: float, minor: float, **keys: object) -> Shape:
    """The half y >= 0 of a torus about z; radii in m, `minor` of the tube."""
    return shape("half_torus", major=major, minor=minor, **keys)


def polyhedron(vertices: Sequence[Sequence[float]], **keys: object) -> Shape:
    """The convex hull of points [x, y, z] in m."""
    return shape("polyhedron", vertices=vertices, **keys)


def extrusion(length: float, **keys: object) -> Shape:
    """A polygon (`points`) or a smooth outline (`x`, `y`, `domain`) along z, centred; `length` in m."""
    return shape("extrusion", length=length, **keys)


def outline(pieces: Sequence[Mapping[str, object]], **keys: object) -> Shape:
    """An outline of pieces (lines, arcs, involutes) in z = 0, as of a thin plate."""
    return shape("outline", pieces=pieces, **keys)


def outline_wall(pieces: Sequence[Mapping[str, object]], length: float, **keys: object) -> Shape:
    """The sides of an outline of pieces along z, without its ends; `length` in m."""
    return shape("outline_wall", pieces=pieces, length=length, **keys)


def solid(
    face: Sequence[Mapping[str, object]],
    edge: Sequence[Mapping[str, object]] = (),
    vertex: Sequence[Mapping[str, object]] = (),
    **keys: object,
) -> Shape:
    """A solid of your own: faces, edges and vertices as in the tables of a scene file."""
    return shape("solid", face=face, edge=edge, vertex=vertex, **keys)


def fixed(name: str, *shapes: Shape, **keys: object) -> Body:
    """A body at rest."""
    return _body(name, "fixed", shapes, keys)


def driven(name: str, *shapes: Shape, path: Mapping[str, object], **keys: object) -> Body:
    """A body on a prescribed path, `{"position": [...], "rotation_vector": [...]}` in expressions of t."""
    return _body(name, "driven", shapes, {"path": path, **keys})


def dynamic(name: str, *shapes: Shape, **keys: object) -> Body:
    """A body that moves by forces; needs mass and inertia, or density."""
    return _body(name, "dynamic", shapes, keys)


def planar(name: str, *shapes: Shape, **keys: object) -> Body:
    """A body that moves by forces in a plane with a `normal`, z unless given."""
    return _body(name, "planar", shapes, keys)


def scene(name: str, bodies: Sequence[Body], **keys: object) -> Scene:
    """The scene of these bodies; other keys as at the top of a scene file. Raises SceneError.

    Bodies of a scene with parameters (`parameter=[{"name": ..., "value": ...}]`) are tables: `body=[...]`.
    """
    SCENE_NAME.read(name, Place(SOURCE, name))
    if "parameter" in keys:
        return _with_parameters(name, bodies, keys)
    place = place_of(Place(SOURCE, name), keys, {})
    values = SCENE.read({"body": [], **keys}, place)
    written = tuple(read_body(each, at) for at, each in values["body"])
    return scene_from_bodies(name, (*bodies, *written), values, place)


def _with_parameters(name: str, bodies: Sequence[Body], keys: Mapping[str, object]) -> Scene:
    """A scene that is read again for other values of its parameters: all of it is tables."""
    if bodies:
        found = "bodies made by functions, in a scene with parameters"
        allowed = "such a scene is read again for each value, from the tables of its bodies"
        raise Place(SOURCE, name).error(
            found, allowed, 'write scene(name, [], body=[{"name": ..., ...}], ...)'
        )
    return scene_from_tables(name, {"body": [], **keys}, SOURCE)


def _body(name: str, motion: str, shapes: tuple[Shape, ...], keys: Mapping[str, object]) -> Body:
    place = Place(SOURCE, f"body {name}")
    values = BODY.read({"name": name, "motion": motion, **keys}, place)
    written = tuple(read_shape(each, at) for at, each in values["shape"])
    return body_of(values, (*shapes, *written), place)
