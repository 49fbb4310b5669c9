"""Every error a user can meet: where, what was found, what is allowed, and the remedy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from os import PathLike
from pathlib import Path

PIPELINE = {  # each value of the pipeline, and the verb that takes it
    "path": "read",
    "Scene": "require",
    "Model": "derive",
    "Derivation": "emit",
    "Package": "build",
    "Library": "simulate",
}


class ModelgenError(Exception):
    """Base of all errors that a user can cause and mend.

    `str(error)` is one message: `<where>: <found>; <allowed>; <remedy>`, parts that are empty left out.
    """

    def __init__(self, where: str, found: str, allowed: str = "", remedy: str = "") -> None:
        super().__init__(where, found, allowed, remedy)
        self.where = where
        self.found = found
        self.allowed = allowed
        self.remedy = remedy

    def __str__(self) -> str:
        tail = "; ".join(part for part in (self.found, self.allowed, self.remedy) if part)
        return f"{self.where}: {tail}" if self.where else tail


class SceneError(ModelgenError):
    """The scene cannot be read or does not describe a system that can be simulated."""


class ExpressionError(ModelgenError):
    """An expression is not in the language of expressions, or has no finite value."""

    def __init__(
        self, where: str, found: str, allowed: str = "", remedy: str = "", position: int | None = None
    ) -> None:
        super().__init__(where, found, allowed, remedy)
        self.args = (where, found, allowed, remedy, position)
        self.position = position  # index of the first character that offends, or None


class CompilerMissing(ModelgenError):  # noqa: N818  the state of the machine, not a mistake
    """No C compiler was found."""


class LibraryError(ModelgenError):
    """A compiled library is stale, foreign, or called with wrong arguments."""


class SimulationError(ModelgenError):
    """A run cannot start or cannot go on."""


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


def synonym(name: str, known: Iterable[str]) -> str:
    """`did you mean 'x'?` for the known name that means the same as `name`, with what changes, or an empty
    text."""
    names = list(known)
    found = [word for word in SYNONYMS.get(name.lower(), ()) if word in names]
    if not found:
        return ""
    note = NOTES.get((name.lower(), found[0]), "")
    return f"did you mean {found[0]!r}{f', {note}' if note else ''}?"


def with_article(noun: str) -> str:
    """ "an ellipsoid"."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def nearest(name: str, known: Iterable[str]) -> str:
    """`did you mean 'x'?` for the known name that means the same as `name` or is closest to it, or an empty
    text."""
    names = list(known)
    close = get_close_matches(name, names, n=1, cutoff=0.6)
    return synonym(name, names) or (f"did you mean {close[0]!r}?" if close else "")


def expect(verb: str, value: object, kind: type) -> None:
    """Raise ModelgenError for a value of the wrong type; the remedy names the call that makes the right one.

    >>> expect("derive", 3, str)
    Traceback (most recent call last):
    modelgen.errors.ModelgenError: derive: the argument is of type int; it takes a str
    """
    if isinstance(value, kind):
        return
    given = "path" if isinstance(value, str | PathLike) else type(value).__name__
    found = f"the argument is of type {type(value).__name__}"
    raise ModelgenError(verb, found, f"it takes a {kind.__name__}", _call(verb, given, kind))


def path_of(verb: str, value: object) -> Path:
    """The path of an argument that is a path or text.

    >>> path_of("read", 3)
    Traceback (most recent call last):
    modelgen.errors.ModelgenError: read: the argument is of type int; it takes a path, as str or Path
    """
    if isinstance(value, str | PathLike):
        return Path(value)
    found = f"the argument is of type {type(value).__name__}"
    raise ModelgenError(verb, found, "it takes a path, as str or Path")


def _call(verb: str, given: str, kind: type) -> str:
    """`write build(emit(derivation))` for a Derivation that `build` was given; from a file if need be."""
    values = list(PIPELINE)
    if kind.__name__ == "Record":
        return f"write {verb}(record_of(trajectory, library), ...)"
    if kind.__name__ not in values:
        return ""
    end = values.index(kind.__name__)
    start = values.index(given) if given in values[:end] else 0
    call = values[start].lower()
    for value in values[start:end]:
        call = f"{PIPELINE[value]}({call})"
    return f"write {verb}({call}{'' if verb in PIPELINE.values() else ', ...'})"
