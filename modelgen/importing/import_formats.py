"""A file of another program as a scene: the formats, what can be chosen for each, and the import."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TypedDict, Unpack

from modelgen.errors import ModelgenError, path_of
from modelgen.importing import profile_scene, robot_scene
from modelgen.importing.import_losses import Notes, check_without
from modelgen.importing.mujoco_shapes import CORNERS
from modelgen.importing.xml_file import first_element
from modelgen.runtime.arguments import (
    check_flag,
    check_keywords,
    check_name,
    check_positive,
    check_span,
    check_whole,
    names_in,
    shown,
)
from modelgen.scene.read import LARGEST, read_text
from modelgen.scene.scene_types import Scene

UNTIL = 1.0  # s


@dataclass(frozen=True)
class Imported:
    """A scene made of a file.

    Attributes:
        text: of the scene file; it begins with what is left out or taken otherwise, as comments.
        scene: what the text says.
        left_out: what of the file is not in the scene, in sentences.
        approximated: what is taken otherwise than in the file, in sentences.
    """

    text: str
    scene: Scene
    left_out: tuple[str, ...]
    approximated: tuple[str, ...]


class Chosen(TypedDict, total=False):
    """The choices of `Choices`, as keywords."""

    key: str | None
    floating: bool
    until: float
    corners: int
    without: Collection[str]
    kind: str | None
    columns: str | None
    unit: str
    tolerance: float | None
    length: float | None


@dataclass(frozen=True)
class Choices:
    """What an import takes beside the file.

    Attributes:
        key: of `mjcf`, name or number of the keyframe that the scene begins with.
        floating: of `urdf`, whether the first link moves freely; else it rests.
        until: end of the run, s.
        corners: of `mjcf` and `urdf`, the most corners of a polyhedron that stands for a mesh.
        without: of `mjcf` and `urdf`, keys of `import_losses.WITHOUT`: parts that may be left out.
        kind: of `profile`, the shape that it becomes: a key of `profile_scene.KINDS`.
        columns: of `profile`, two names or numbers, as "r,z"; the first two when None.
        unit: of `profile`, of the file: m, cm, mm, um or in.
        tolerance: of `profile`, by which averages of points may lie off the spline, m; their noise when None.
        length: of `profile`, of a wall or extrusion, m; 1 when None.
    """

    key: str | None = None
    floating: bool = False
    until: float = UNTIL
    corners: int = CORNERS
    without: Collection[str] = ()
    kind: str | None = None
    columns: str | None = None
    unit: str = "m"
    tolerance: float | None = None
    length: float | None = None


def _robot(path: Path, urdf: bool, choices: Choices, notes: Notes) -> str:
    reading = robot_scene.Reading(urdf, choices.key, choices.floating, choices.corners)
    return robot_scene.robot_text(path, reading, choices.until, notes)


def _profile(path: Path, choices: Choices, notes: Notes) -> str:
    reading = profile_scene.Reading(
        choices.kind, choices.columns, choices.unit, choices.tolerance, choices.length
    )
    return profile_scene.profile_text(path, reading, choices.until, notes)


FORMATS: Mapping[str, Callable[[Path, Choices, Notes], str]] = {
    "mjcf": lambda path, choices, notes: _robot(path, False, choices, notes),
    "urdf": lambda path, choices, notes: _robot(path, True, choices, notes),
    "profile": _profile,
}
_OF_PROFILES = ("kind", "columns", "unit", "tolerance", "length")
OPTIONS: Mapping[str, tuple[str, ...]] = {  # by format, choices that it takes
    "mjcf": ("key", "corners", "without"),
    "urdf": ("floating", "corners", "without"),
    "profile": _OF_PROFILES,
}
WORDS = {
    "key": "--key",
    "floating": "--floating",
    "corners": "--corners",
    "without": "--without",
    "kind": "--as",
} | {name: f"--{name}" for name in _OF_PROFILES[1:]}
ROOTS = {"mujoco": "mjcf", "robot": "urdf"}  # first element of a file
TEXTS = (".csv", ".txt", ".dat")  # ends of the names of profiles


def import_scene(path: str | Path, format: str | None = None, **choices: Unpack[Chosen]) -> Imported:
    """The scene of a file: MJCF, URDF, or a measured profile.

    Args:
        path: of the file.
        format: a key of FORMATS; by the file itself when None.
        choices: those of `Choices`, by name.

    Raises:
        ModelgenError: the file cannot be read, is of no known format, or has parts that a scene has no like
            of.
    """
    check_keywords("import_scene", choices, [each.name for each in fields(Choices)])
    chosen, path = Choices(**choices), path_of("import_scene", path)
    _check(chosen)
    check_without(chosen.without)
    name = _format(path, format)
    for key, word in WORDS.items():
        if key not in OPTIONS[name] and getattr(chosen, key) != getattr(Choices(), key):
            takers = " and ".join(each for each, keys in OPTIONS.items() if key in keys)
            raise ModelgenError(word, f"it with a file of {name}", f"it goes with {takers}", "leave it out")
    notes = Notes(str(path), chosen.without)
    text = FORMATS[name](path, chosen, notes)
    if (size := len(text.encode())) > LARGEST:
        remedy = "let fewer pairs of bodies touch, by the contact bits or exclusions of the file"
        raise ModelgenError(
            str(path), f"a scene of {size} bytes", f"a scene file has at most {LARGEST}", remedy
        )
    scene = read_text(text, f"{path.stem}.toml")
    return Imported(text, scene, tuple(notes.left_out), tuple(notes.approximated))


def _check(choices: Choices) -> None:
    """Raises ModelgenError for a choice of the wrong type."""
    check_span("until", choices.until, "give the end of the run")
    check_flag("floating", choices.floating)
    check_whole("corners", choices.corners, "give the most corners of a polyhedron", 4)
    names_in("without", choices.without)
    for name in ("tolerance", "length"):
        if getattr(choices, name) is not None:
            check_positive(name, getattr(choices, name), "give a number of m")
    for name in ("key", "kind", "columns", "unit"):
        if not isinstance(getattr(choices, name), str | None):
            raise ModelgenError(name, shown(getattr(choices, name)), "a text", "give one, or leave it out")


def _format(path: Path, format: str | None) -> str:
    allowed = "allowed: " + ", ".join(FORMATS)
    if format is not None:
        check_name("format", format, FORMATS)
    if not path.is_file():
        raise ModelgenError(str(path), "no such file", "", "check the path")
    if format is not None:
        return format
    if path.suffix.lower() in TEXTS:
        return "profile"
    root = first_element(path)
    if root == "sdf":
        remedy = "convert it to URDF or MJCF"
        raise ModelgenError(str(path), "SDF, for which there is no kept parser in Python", allowed, remedy)
    if root not in ROOTS:
        raise ModelgenError(str(path), "a file of no known format", allowed, "name it with --format")
    return ROOTS[root]
