"""The street as the verbs walk it: from a file to a library and a run, with progress on standard error."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import Progress

import modelgen
from modelgen.cli.options import AccuracyName, RealName
from modelgen.errors import ModelgenError

if TYPE_CHECKING:
    from modelgen.codegen.library import Library
    from modelgen.derive import Derivation
    from modelgen.runtime.trajectory import Trajectory
    from modelgen.scene.types import Scene


def read_scene(path: Path, form: str | None) -> Scene:
    scene = modelgen.read(path)
    if form is None:
        return scene
    return replace(scene, contacts=tuple(replace(contact, form=form) for contact in scene.contacts))


def derive_scene(scene: Scene) -> Derivation:
    with progress("deriving"):
        return modelgen.derive(modelgen.require(scene))


def folder_of(scene: Scene, form: str | None) -> Path:
    """Where a scene is built; a forced form has a folder of its own, beside the reviewed manifest."""
    return Path("generated") / (scene.name if form is None else f"{scene.name}.{form}")


def build_scene(scene: Scene, folder: Path, real: RealName = RealName.double) -> Library:
    derivation = derive_scene(scene)
    with progress("compiling"):
        return modelgen.build(modelgen.emit(derivation), real=real.value, folder=folder)


def run_scene(
    path: Path,
    form: str | None,
    until: float | None,
    accuracy: modelgen.Accuracy | None,
    samples: int | None,
) -> tuple[Trajectory, Library]:
    """Build and run; a start that is refused leaves no folder behind that was not there before."""
    scene = read_scene(path, form)
    with _removed_if_refused(folder_of(scene, form)) as folder:
        library = build_scene(scene, folder)
        with progress("simulating") as report:
            trajectory = modelgen.simulate(
                library, until=until, accuracy=accuracy, samples=samples, on_progress=report
            )
    return trajectory, library


@contextmanager
def _removed_if_refused(folder: Path) -> Iterator[Path]:
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        yield folder
    except ModelgenError:
        if made:
            shutil.rmtree(made[-1], ignore_errors=True)
        raise


def accuracy_of(name: AccuracyName | None, tolerance: float | None) -> modelgen.Accuracy | None:
    if tolerance is not None:
        return modelgen.Accuracy.of(tolerance)
    return None if name is None else modelgen.Accuracy.named(name.value)


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """A bar on standard error, fed with the share that is done; it pulses until it is fed."""
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(label, total=None)
        yield lambda share: bar.update(task, total=1.0, completed=share)
