"""Writes a scene in a format for use elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from modelgen.benchmark.peers.mjcf import different
from modelgen.codegen.build import build
from modelgen.codegen.emit import Package, emit
from modelgen.codegen.library import Library
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError
from modelgen.export.browser_page import browser_page
from modelgen.export.c_folder import c_files
from modelgen.export.casadi_folder import casadi_files
from modelgen.export.fmu import fmu_files
from modelgen.export.jax_folder import jax_files
from modelgen.export.mjcf_file import check_mjcf, mjcf_files, setup_of
from modelgen.export.urdf_file import check_urdf, left_out, urdf_files
from modelgen.file_writing import write_files
from modelgen.name_suggestions import nearest
from modelgen.runtime.arguments import with_parameters

Content = str | bytes


@dataclass(frozen=True, slots=True)
class Choices:
    """What is written beside the scene itself.

    Attributes:
        real: "double", "float" or "long double"; the scene's own when None. Of `c` and `fmu`.
        parameters: values of parameters of the scene by name; others keep the scene's own. Of `c`, `fmu`
            and `jax`.
        figures: of `c`, whether flash, RAM, stack and instructions are measured.
        states: of `fmu`, whether the states of bodies are outputs.
        step: of `mjcf`, step of the simulation, s.
    """

    real: str | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    figures: bool = True
    states: bool = False
    step: float | None = None


@dataclass(frozen=True, slots=True)
class Exported:
    """What was written.

    Attributes:
        files: paths of the files.
        approximated: what of the scene the format represents otherwise, a phrase each.
        left_out: what of the scene is not in the files, a phrase each.
    """

    files: Sequence[Path]
    approximated: Sequence[str] = ()
    left_out: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class _Given:
    """What a format is written from."""

    derivation: Derivation
    choices: Choices
    scratch: Path
    page: str  # name of the file of a page

    def package(self, derivatives: bool = False) -> Package:
        return emit(self.derivation, derivatives)

    def library(self, package: Package) -> Library:
        library = build(package, real=self.choices.real, folder=self.scratch)
        return with_parameters(library, self.choices.parameters)


def _c(given: _Given) -> Mapping[str, Content]:
    package = given.package()
    return c_files(given.library(package), package, given.choices.figures)


def _fmu(given: _Given) -> Mapping[str, Content]:
    package = given.package()
    return fmu_files(given.library(package), package, given.choices.states)


def _casadi(given: _Given) -> Mapping[str, Content]:
    return casadi_files(given.derivation, given.package())


def _jax(given: _Given) -> Mapping[str, Content]:
    package = given.package(derivatives=True)
    return jax_files(given.library(package), package)


def _browser(given: _Given) -> Mapping[str, Content]:
    model, package = given.derivation.model, given.package()
    return {given.page: browser_page(model.whole, given.library(package), package, given.choices.parameters)}


def _mjcf(given: _Given) -> Mapping[str, Content]:
    scene = given.derivation.model.scene
    check_mjcf(scene)
    return mjcf_files(scene, given.library(given.package()), given.choices.step)


def _urdf(given: _Given) -> Mapping[str, Content]:
    scene = given.derivation.model.scene
    check_urdf(scene)
    return urdf_files(setup_of(scene, given.library(given.package())))


FORMATS: Mapping[str, Callable[[_Given], Mapping[str, Content]]] = {
    "c": _c,
    "fmu": _fmu,
    "casadi": _casadi,
    "jax": _jax,
    "mjcf": _mjcf,
    "urdf": _urdf,
    "browser": _browser,
}  # fmt: skip
PAGES = ("browser",)  # formats of one file
OPTIONS: Mapping[str, tuple[str, ...]] = {  # by format, choices that it takes
    "c": ("real", "parameters", "figures"),
    "fmu": ("real", "parameters", "states"),
    "casadi": (),
    "jax": ("parameters",),
    "browser": ("parameters",),
    "mjcf": ("step",),
    "urdf": (),
}
WORDS = {"real": "--real", "parameters": "--set", "states": "--states", "step": "--step"}


def check_format(name: str | None, choices: Choices) -> str:
    """The name of a format. Raises ModelgenError if there is none, or a choice is none of its own."""
    allowed = f"allowed: {', '.join(FORMATS)}"
    if name is None or name not in FORMATS:
        found, meant = ("no format", "write --to c") if name is None else (repr(name), nearest(name, FORMATS))
        raise ModelgenError("--to", found, allowed, meant)
    for key, word in WORDS.items():
        if key not in OPTIONS[name] and getattr(choices, key) != getattr(Choices(), key):
            takers = " and ".join(each for each, keys in OPTIONS.items() if key in keys)
            raise ModelgenError(
                word, f"it is given with --to {name}", f"it goes with {takers}", "leave it out"
            )
    return name


def export(derivation: Derivation, to: str, out: Path, scratch: Path, choices: Choices) -> Exported:
    """Write a scene in a format into a folder, or as a page.

    Args:
        derivation: what `derive` returned.
        to: a key of FORMATS.
        out: the folder, in which other files stay; of a format of PAGES the file. Folders are made.
        scratch: folder in which the library of the scene is built.
        choices: what is written beside the scene itself.

    Raises:
        ModelgenError: the format is unknown, or has no like of something in the scene.
        CompilerMissing, LibraryError: the library of the scene cannot be built.
        ModelgenError: a file cannot be written; then all are as they were.
    """
    name = check_format(to, choices)
    folder = out.parent if name in PAGES else out
    contents = FORMATS[name](_Given(derivation, choices, scratch, out.name))
    files = {folder / file: content for file, content in contents.items()}
    write_files(files)
    scene = derivation.model.scene
    return Exported(
        list(files),
        different(scene) if name == "mjcf" else (),
        left_out(scene) if name == "urdf" else (),
    )
