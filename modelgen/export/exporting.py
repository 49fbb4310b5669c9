"""Writes a scene in a format for use elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from modelgen.codegen.build import build
from modelgen.codegen.emit import emit
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError, nearest
from modelgen.export.c_folder import c_files

Content = str | bytes


@dataclass(frozen=True, slots=True)
class Choices:
    """What is written beside the scene itself.

    Attributes:
        real: "double", "float" or "long double"; the scene's own when None.
        figures: of `c`, whether flash, RAM, stack and instructions are measured.
        states: of `fmu`, whether the states of bodies are outputs.
    """

    real: str | None = None
    figures: bool = True
    states: bool = False


def _c(derivation: Derivation, choices: Choices, scratch: Path) -> Mapping[str, Content]:
    package = emit(derivation)
    return c_files(build(package, real=choices.real, folder=scratch), package, choices.figures)


FORMATS: Mapping[str, Callable[[Derivation, Choices, Path], Mapping[str, Content]]] = {"c": _c}


def check_format(name: str | None) -> str:
    """The name of a format. Raises ModelgenError if there is no such format."""
    if name in FORMATS:
        return str(name)
    allowed = f"allowed: {', '.join(FORMATS)}"
    raise ModelgenError(
        "--to", "no format" if name is None else repr(name), allowed, nearest(name or "", FORMATS)
    )


def export(derivation: Derivation, to: str, folder: Path, scratch: Path, choices: Choices) -> list[Path]:
    """Write a scene in a format into a folder; the files that were written.

    Args:
        derivation: what `derive` returned.
        to: a key of FORMATS.
        folder: where; it is made if it does not exist. Other files in it stay.
        scratch: folder in which the library of the scene is built.
        choices: what is written beside the scene itself.

    Raises:
        ModelgenError: the format is unknown, or has no like of something in the scene.
        CompilerMissing, LibraryError: the library of the scene cannot be built.
    """
    contents = FORMATS[check_format(to)](derivation, choices, scratch)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, content in contents.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        written.append(path)
    return written
