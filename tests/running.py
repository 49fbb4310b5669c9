"""Walking the pipeline in tests: scenes built once a session, then run as often as needed."""

from __future__ import annotations

from atexit import register
from dataclasses import replace
from functools import cache
from os import environ
from pathlib import Path
from shutil import copy, rmtree
from tempfile import mkdtemp

from modelgen import Accuracy, build, derive, emit, read, require, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.types import Scene

SCENES = Path(__file__).parent.parent / "scenes"
FILES = tuple(sorted(path for path in SCENES.glob("*.toml") if not path.stem.endswith("_tuned")))  # by `tune`
NAMES = tuple(path.stem for path in FILES)


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


def library_of(scene: Scene, real: str = "double") -> Library:
    """The compiled library of a scene; equal text is compiled once."""
    package = emit(derive(require(scene)))
    pooled = build(replace(package, name="any"), real=real, folder=pool())
    own = folder() / scene.name / pooled.path.name.replace("libany", f"lib{scene.name}")
    own.parent.mkdir(exist_ok=True)
    if not own.exists():
        copy(pooled.path, own)
    return build(package, real=real, folder=own.parent)


@cache
def scene_of(name: str, form: str = "auto", real: str = "double") -> Library:
    """The compiled library of a shipped scene, with one form forced on every contact."""
    scene = read(SCENES / f"{name}.toml")
    contacts = tuple(replace(pair, form=form) for pair in scene.contacts)
    return library_of(replace(scene, contacts=contacts), real)


def run(
    name: str, accuracy: Accuracy, form: str = "auto", real: str = "double", **options: object
) -> Trajectory:
    """A run of a shipped scene."""
    return simulate(scene_of(name, form, real), accuracy=accuracy, estimate=False, **options)  # type: ignore[arg-type]
