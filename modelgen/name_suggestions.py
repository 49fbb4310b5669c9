"""The known name that a user may have meant: by synonyms, then by spelling."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

LISTED = 100  # names that a message gives of many; a scene of splines has thousands of contacts

SYNONYMS: Mapping[
    str, tuple[str, ...]
] = {  # other words for kinds of shapes, joints and motions, and for keys
    **dict.fromkeys(("cube", "cuboid", "brick", "block", "rectangle"), ("box",)),
    **dict.fromkeys(("ball", "globe"), ("sphere", "spherical")),
    **dict.fromkeys(("can", "coin", "puck", "tin", "wheel"), ("disc",)),
    **dict.fromkeys(("pill", "sausage"), ("capsule",)),
    **dict.fromkeys(("ring", "donut", "doughnut", "tyre", "tire"), ("torus",)),
    **dict.fromkeys(("floor", "ground", "wall", "halfspace", "half_space"), ("plane",)),
    **dict.fromkeys(("mesh", "hull", "tetrahedron", "pyramid"), ("polyhedron",)),
    **dict.fromkeys(("prism",), ("extrusion",)),
    **dict.fromkeys(("terrain", "heightfield", "heightmap"), ("height_field",)),
    **dict.fromkeys(("egg", "spheroid"), ("ellipsoid",)),
    **dict.fromkeys(("spring", "coil"), ("helix",)),
    **dict.fromkeys(("wire", "spline"), ("curve", "bspline_curve")),
    **dict.fromkeys(("hinge", "pin", "pivot"), ("revolute",)),
    **dict.fromkeys(("slider", "slide", "rail"), ("prismatic",)),
    **dict.fromkeys(("ball_joint", "socket"), ("spherical",)),
    **dict.fromkeys(("cardan", "hooke"), ("universal",)),
    **dict.fromkeys(("rigid", "lock"), ("weld",)),
    **dict.fromkeys(("cable", "string", "tether"), ("rope",)),
    **dict.fromkeys(("static", "rest"), ("fixed",)),
    **dict.fromkeys(("kinematic", "moving", "prescribed"), ("driven",)),
    **dict.fromkeys(("free",), ("dynamic",)),
    **dict.fromkeys(("height", "depth", "thickness"), ("length", "size")),
    **dict.fromkeys(("x", "y", "z", "width", "dimensions", "extents", "sides"), ("size",)),
    **dict.fromkeys(("diameter", "r", "outer_radius", "radius_outer"), ("radius",)),
    **dict.fromkeys(("radii", "axes", "semiaxes", "radius"), ("semi_axes",)),
    **dict.fromkeys(("inner_radius", "radius_inner", "hole"), ("bore",)),
    **dict.fromkeys(("type", "shape"), ("kind",)),
    **dict.fromkeys(("bodies", "pair", "partners", "body1", "body_1", "body_a", "a", "first"), ("between",)),
    **dict.fromkeys(("weight",), ("mass",)),
    **dict.fromkeys(("rho",), ("density",)),
    **dict.fromkeys(("moments", "moment_of_inertia"), ("inertia",)),
    **dict.fromkeys(("com", "centre_of_mass"), ("center_of_mass",)),
    **dict.fromkeys(("pos", "origin", "translation", "at", "anchor", "center", "centre"), ("position",)),
    **dict.fromkeys(("speed", "linear_velocity"), ("velocity",)),
    **dict.fromkeys(("omega", "spin", "rotation_rate"), ("angular_velocity",)),
    **dict.fromkeys(("euler", "angles"), ("rpy",)),
    **dict.fromkeys(("orientation", "quat"), ("quaternion",)),
    **dict.fromkeys(("mu", "friction_coefficient"), ("friction",)),
    **dict.fromkeys(("bounce", "bounciness", "elasticity", "e"), ("restitution",)),
    **dict.fromkeys(("duration", "end", "end_time", "t_end", "time"), ("until",)),
    **dict.fromkeys(("dt", "timestep", "time_step", "h"), ("step",)),
    **dict.fromkeys(("integrator",), ("method",)),
    **dict.fromkeys(("tol", "rtol"), ("tolerance",)),
    **dict.fromkeys(("stiffness_coefficient", "k"), ("stiffness",)),
    **dict.fromkeys(("c", "damping_coefficient"), ("damping",)),
    **dict.fromkeys(("length", "natural_length", "l0"), ("rest_length",)),
    **dict.fromkeys(("points", "attachments"), ("anchors",)),
    "pitch": ("lead",),
}
NOTES: Mapping[tuple[str, str], str] = {  # what changes where one word takes the place of another
    ("diameter", "radius"): "half the diameter",
    ("weight", "mass"): "in kg",
    ("pitch", "lead"): "the rise in a turn: 2*pi times that in a radian",
    **{(key, "size"): "[x, y, z]" for key in ("x", "y", "z", "width", "height", "depth", "thickness")},
}


def listed(names: Iterable[str], most: int = LISTED) -> str:
    """Names with commas between them, of more than `most` the first and how many more there are."""
    known = list(names)
    rest = len(known) - most
    return ", ".join(known[:most]) + (f" and {rest} more" if rest > 0 else "")


def synonym(name: str, known: Iterable[str]) -> str:
    """`did you mean 'x'?` for the known name that means the same as `name`, with what changes, or an empty
    text."""
    names = list(known)
    found = [word for word in SYNONYMS.get(name.lower(), ()) if word in names]
    if not found:
        return ""
    note = NOTES.get((name.lower(), found[0]), "")
    return f"did you mean {found[0]!r}{f', {note}' if note else ''}?"


def nearest(name: object, known: Iterable[str]) -> str:
    """`did you mean 'x'?` for the known name that means the same as `name`, as a pair in the other order, or
    is closest to it, or an empty text."""
    name, names = str(name), list(known)
    from difflib import get_close_matches  # a command that goes well needs none

    exchanged = [each for each in names if is_exchanged(each, name)]
    close = exchanged or get_close_matches(name, names, n=1, cutoff=0.6)
    return synonym(name, names) or (f"did you mean {close[0]!r}?" if close else "")


def is_exchanged(name: str, other: str) -> bool:
    """Whether two names are of one pair in both orders: `ring-ball:rim` and `ball-ring:rim`."""
    (pair, _, rest), (given, _, given_rest) = name.partition(":"), other.partition(":")
    return rest == given_rest and pair.split("-") == given.split("-")[::-1]
