"""The pipeline of the commands: from a scene file to a library and a run, with progress on standard error."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import modelgen
from modelgen.cli.built_library_lookup import recall, remember, scene_key
from modelgen.cli.option_reading import read_option
from modelgen.cli.progress import activity, progress
from modelgen.errors import ModelgenError
from modelgen.interruption import nothing_swallowed
from modelgen.scene.scene_name import scene_name

if TYPE_CHECKING:
    from modelgen.codegen.library import Library
    from modelgen.derivation import Derivation
    from modelgen.identification.fit import Fit
    from modelgen.runtime.trajectory import Trajectory
    from modelgen.scene.scene_types import Scene

Result = TypeVar("Result")

DERIVATIVES = "derivatives"  # end of the name of a folder, as that of a form


def read_scene(path: Path, form: str | None) -> Scene:
    scene = modelgen.read(path)
    name = read_option("form", form)
    if name is None:
        return scene
    from modelgen.scene.scene_from_tables import with_form  # a scene that was built before is not assembled

    return with_form(scene, name)


def derive_scene(scene: Scene) -> Derivation:
    with progress("deriving"), nothing_swallowed():  # in the import of CasADi either
        return modelgen.derive(modelgen.require(scene))


def folder_of(scene: Scene, form: str | None) -> Path:
    """The folder in which a scene is built. A forced form has its own folder, beside that of the committed
    manifest."""
    return _folder(scene.name, form)


def _folder(name: str, form: str | None) -> Path:
    return Path("generated") / (name if form is None else f"{name}.{form}")


GENERATED = (
    "a folder for the generated files, `generated` in the current one where none is named",
    "go to another folder, or name one: build --out FOLDER",
)


def check_folder(folder: Path, allowed: str = GENERATED[0], remedy: str = GENERATED[1]) -> None:
    """Raise ModelgenError for a folder that cannot be written, before anything is derived."""
    try:
        nearest = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    except OSError as cause:
        found = f"it cannot be written: {cause.strerror}"
        raise ModelgenError(str(folder), found, allowed, remedy) from cause
    if not nearest.is_dir():
        raise ModelgenError(str(folder), f"{str(nearest)!r} is a file", allowed, remedy)
    if not os.access(nearest, os.W_OK | os.X_OK):
        found = f"{str(nearest)!r} is not yours to write into"
        raise ModelgenError(str(folder), found, allowed, remedy)


def build_scene(scene: Scene, folder: Path, real: str | None = None, derivatives: bool = False) -> Library:
    check_folder(folder)
    return build_derivation(derive_scene(scene), folder, real, derivatives)


def build_derivation(
    derivation: Derivation,
    folder: Path,
    real: str | None = None,
    derivatives: bool = False,
    check: Callable[[Mapping[str, Any]], None] = lambda instance: None,
) -> Library:
    """`check` is given the instance of the manifest, before anything is compiled."""
    check_folder(folder)
    with progress("compiling"):
        package = modelgen.emit(derivation, derivatives)
        check(package.manifest.instance)
        try:
            return modelgen.build(package, real=real, folder=folder)
        except OSError as cause:
            found = f"it cannot be written: {cause.strerror}"
            raise ModelgenError(str(folder), found, *GENERATED) from cause


def run_scene(path: Path, form: str | None, settings: dict[str, Any]) -> tuple[Trajectory, Library]:
    """Build a scene and run it with keywords of `simulate`. If the start is refused, a new folder is removed
    again."""
    with ready_library(path, form) as library, progress("simulating") as report:
        trajectory = modelgen.simulate(library, on_progress=report, **settings)
    return trajectory, library


@contextmanager
def ready_library(path: Path, form: str | None) -> Iterator[Library]:
    """The library of a scene file; a new folder is removed again if what is done with it is refused."""
    with removed_if_refused(_folder(scene_name(path.name), form)) as folder:
        yield _known_or_built(path, form, folder)


def _known_or_built(path: Path, form: str | None, folder: Path) -> Library:
    """The library of a scene file; where it was built before, nothing is read or derived."""
    key = scene_key(path, read_option("form", form) or "")
    known = None if key is None else recall(folder, key)
    if known is not None:
        return known
    library = build_scene(read_scene(path, form), folder)
    if key is not None:
        remember(library, key)
    return library


def fit_scene(path: Path, data: list[Path], settings: dict[str, Any]) -> Fit:
    """Fit a scene to recordings with keywords of `fit`. Its library has derivatives, and a folder of its own;
    if the fit is refused, a new folder is removed again."""
    from modelgen.identification.fit import recording_in
    from modelgen.identification.unknowns import unknowns_of

    def check(instance: Mapping[str, Any]) -> None:
        unknowns_of(instance, settings["by"], len(recordings), settings["inputs"])

    scene = read_scene(path, None)
    recordings = [recording_in(each, settings["of"]) for each in data]  # before anything is compiled
    with removed_if_refused(folder_of(scene, DERIVATIVES)) as folder:
        library = build_derivation(derive_scene(scene), folder, derivatives=True, check=check)
        with activity("fitting") as report:
            return modelgen.fit(library, recordings, on_progress=report, **settings)


def linearise_scene(path: Path, form: str | None, find: Callable[..., Result]) -> Result:
    """What `find` makes of the derivation, the library and a function that takes its progress. If it refuses,
    a new folder is removed again."""
    scene = read_scene(path, form)
    with removed_if_refused(folder_of(scene, form)) as folder:
        derivation = derive_scene(scene)
        library = build_derivation(derivation, folder)
        with progress("linearising") as report:
            return find(derivation, library, report)


@contextmanager
def removed_if_refused(folder: Path) -> Iterator[Path]:
    """If a command is refused, the folder is removed if it is new, and so are those above it, unless another
    command has put something there meanwhile."""
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        yield folder
    except ModelgenError:
        for path in made[:1]:
            shutil.rmtree(path, ignore_errors=True)
        with suppress(OSError):
            for path in made[1:]:
                path.rmdir()
        raise
