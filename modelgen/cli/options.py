"""Options that several commands share. Their values are texts, which `option_reading` reads."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from modelgen.cli.command import Argument, Option
from modelgen.scene.run_choices import ACCURACIES, METHODS, REALS, SCHEMES, SOLVERS

STYLES = ("text", "latex", "html")


def _among(names: tuple[str, ...]) -> str:
    return f"[{'|'.join(names)}]"


SceneFile = Annotated[Path, Argument(metavar="SCENE", help="scene file, TOML")]
AsJson = Annotated[bool, Option("--json", help="print one JSON object on standard output")]
Brief = Annotated[
    bool, Option("--brief", help="without what decisions save, for which the scene is derived again")
]
Form = Annotated[str | None, Option(help="form of the contact equations for all contacts", metavar="NAME")]
Until = Annotated[str | None, Option(help="end time, s; default: the scene's own", metavar="NUMBER")]
Samples = Annotated[str | None, Option(help="output intervals; default: the scene's own", metavar="NUMBER")]
Quality = Annotated[str | None, Option(help="default: the scene's own", metavar=_among(ACCURACIES))]
Tolerance = Annotated[
    str | None,
    Option(help="local error of a step, relative; overrides --accuracy", metavar="NUMBER"),
]
Method = Annotated[
    str | None, Option(help="of integration; default: the scene's own", metavar=_among(METHODS))
]
Step = Annotated[
    str | None, Option(help="fixed step of rk4, time-stepping, exported MJCF, s", metavar="NUMBER")
]
Scheme = Annotated[str | None, Option(help="of time-stepping", metavar=_among(SCHEMES))]
Solver = Annotated[str | None, Option(help="what solves for forces and impulses", metavar=_among(SOLVERS))]
Fallback = Annotated[
    bool | None, Option(help="time-stepping for a while where an event-driven run would end")
]
Values = Annotated[
    list[str] | None,
    Option("--set", help="value of a parameter of the scene, in SI units; repeat it", metavar="NAME=NUMBER"),
]
InputValues = Annotated[
    list[str] | None,
    Option("--input", help="value of an input of the scene, in its unit; repeat it", metavar="NAME=NUMBER"),
]
Estimated = Annotated[
    bool | None,
    Option("--estimate/--no-estimate", help="tell the error of the run by a second, finer run"),
]
RealName = Annotated[
    str | None,
    Option(help="the real type of the library; default: the scene's own", metavar=_among(REALS)),
]
Derivatives = Annotated[bool, Option(help="with derivatives of runs (mg_advance_tangent)")]
MainFile = Annotated[str | None, Option(hidden=True)]  # of versions before `export`
Style = Annotated[str, Option("--format", help="how formulas are written", metavar=_among(STYLES))]
At = Annotated[
    str | None,
    Option(help="where numbers are substituted: a seed, or FILE.json of inputs", metavar="SEED|FILE"),
]
Frames = Annotated[
    str | None,
    Option(help="pictures of the bodies: at the start, a change of mode, and on", metavar="NUMBER"),
]
Verify = Annotated[
    str | None, Option(help="recompute each status on so many configurations", metavar="NUMBER")
]
OutFolder = Annotated[Path | None, Option(help="folder for the generated files", metavar="FOLDER")]
OutRun = Annotated[Path | None, Option(help="write the run to FILE.npz or FILE.csv", metavar="FILE")]
OutPicture = Annotated[Path | None, Option(help="draw the run to FILE.png or FILE.svg", metavar="FILE")]
