"""Walking the pipeline in tests: scenes built once a session, then run as often as needed."""

from __future__ import annotations

from atexit import register
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from fcntl import LOCK_EX, flock
from functools import cache
from os import environ
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any

from modelgen import Accuracy, build, derive, emit, read, require, simulate
from modelgen.codegen.build import source_hash
from modelgen.codegen.emit import Package
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_types import Scene

SCENES = Path(__file__).parent.parent / "scenes"
FILES = tuple(sorted(path for path in SCENES.glob("*.toml") if not path.stem.endswith("_tuned")))  # by `tune`
NAMES = tuple(path.stem for path in FILES)

LEVEL = "O1"


def copied(value: Any) -> Any:
    """Tables of their own for each entry; in those of a scene several bodies may have one for their shape."""
    if isinstance(value, dict):
        return {key: copied(each) for key, each in value.items()}
    return [copied(each) for each in value] if isinstance(value, list) else value


@cache
def folder() -> Path:
    """One folder of built libraries for the whole session."""
    made = Path(mkdtemp(prefix="modelgen-tests-"))
    register(rmtree, made, ignore_errors=True)
    return made


@cache
def pool() -> Path:
    """A folder of libraries that all workers of a test run share."""
    return Path(environ["MODELGEN_POOL"]) if "MODELGEN_POOL" in environ else folder() / "pool"


@contextmanager
def held(path: Path) -> Iterator[None]:
    """A file that one process at a time holds."""
    with path.open("a") as file:
        flock(file, LOCK_EX)
        yield


def compiled(package: Package, real: str = "double") -> Library:
    """The library of a package; equal text is compiled once in a test run, whatever its numbers.

    Level O1 computes the same bits as O2, and compiles twice as fast.
    """
    shared = pool() / source_hash(package, real, LEVEL)[:16]
    shared.mkdir(parents=True, exist_ok=True)
    with held(shared / ".lock"):
        return build(replace(package, name="shared"), real=real, level=LEVEL, folder=shared)


def library_of(scene: Scene, real: str = "double") -> Library:
    """The compiled library of a scene."""
    return compiled(emit(derive(require(scene))), real)


@cache
def scene_of(name: str, form: str = "auto", real: str = "double") -> Library:
    """The compiled library of a shipped scene, with one form forced on every contact."""
    scene = read(SCENES / f"{name}.toml")
    contacts = tuple(replace(pair, form=form) for pair in scene.contacts)
    return library_of(replace(scene, contacts=contacts), real)


def with_velocity(library: Library, body: str, velocity: Sequence[float]) -> Library:
    """The library with another velocity and angular velocity (6,) of a body at the start."""
    instance = library.manifest.instance
    first = next(each for each in instance["bodies"] if each["name"] == body)["u"]
    u = list(instance["initial_u"])
    u[first : first + 6] = map(float, velocity)
    return library.with_instance(instance | {"initial_u": u})


def run(
    name: str, accuracy: Accuracy, form: str = "auto", real: str = "double", **options: object
) -> Trajectory:
    """A run of a shipped scene."""
    return simulate(scene_of(name, form, real), accuracy=accuracy, estimate=False, **options)  # type: ignore[arg-type]
