"""The options that several verbs share."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class AccuracyName(StrEnum):
    fast = "fast"
    balanced = "balanced"
    tight = "tight"


class RealName(StrEnum):
    double = "double"
    float = "float"
    long_double = "long double"


class Style(StrEnum):
    text = "text"
    latex = "latex"


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="scene file, TOML")]
AsJson = Annotated[bool, typer.Option("--json", help="print one JSON object on standard output")]
Form = Annotated[str | None, typer.Option(help="form of the contact equations for all contacts")]
Until = Annotated[float | None, typer.Option(help="end time, s; default: the scene's own")]
Samples = Annotated[int | None, typer.Option(help="output intervals; default: the scene's own")]
Quality = Annotated[AccuracyName | None, typer.Option(help="default: the scene's own")]
Tolerance = Annotated[
    float | None, typer.Option(help="local error of a step, relative; overrides --accuracy")
]
OutRun = Annotated[Path | None, typer.Option(help="write the run to FILE.npz or FILE.csv", metavar="FILE")]
OutPicture = Annotated[Path | None, typer.Option(help="draw the run to FILE.png or FILE.svg", metavar="FILE")]
