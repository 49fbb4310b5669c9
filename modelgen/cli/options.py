"""Options that several commands share. Their values are text and are read by the rules of scene files."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer

from modelgen.errors import ModelgenError, SceneError
from modelgen.scene.run_settings import ACCURACIES, FORMS, METHODS, REALS, RUN, SCHEMES, SOLVERS
from modelgen.scene.scalar_types import NUMBER, POSITIVE, Choice, Real, Type, Whole
from modelgen.scene.source_location import Place

STYLES = ("text", "latex", "html")
TYPES: dict[str, Type] = {
    **{field.key: field.type for field in RUN.fields},
    "form": Choice(FORMS),
    "real": Choice(REALS),
    "format": Choice(STYLES),
    "verify": Whole(1, 100_000),
    "at": Whole(0, 2**31 - 1),
    "frames": Whole(1, 16),
    "starts": Whole(1, 1000),
    "seed": Whole(0, 2**31 - 1),
    "port": Whole(1, 65535),
    "runs": Whole(1, 10_000_000),
    "threads": Whole(1, 1024),
    "corners": Whole(4, 1000),
    "length": POSITIVE,
}


def _among(names: tuple[str, ...]) -> str:
    return f"[{'|'.join(names)}]"


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="scene file, TOML", readable=False)]
AsJson = Annotated[bool, typer.Option("--json", help="print one JSON object on standard output")]
Brief = Annotated[
    bool, typer.Option("--brief", help="without what decisions save, for which the scene is derived again")
]
Form = Annotated[
    str | None, typer.Option(help="form of the contact equations for all contacts", metavar="NAME")
]
Until = Annotated[str | None, typer.Option(help="end time, s; default: the scene's own", metavar="NUMBER")]
Samples = Annotated[
    str | None, typer.Option(help="output intervals; default: the scene's own", metavar="NUMBER")
]
Quality = Annotated[str | None, typer.Option(help="default: the scene's own", metavar=_among(ACCURACIES))]
Tolerance = Annotated[
    str | None,
    typer.Option(help="local error of a step, relative; overrides --accuracy", metavar="NUMBER"),
]
Method = Annotated[
    str | None, typer.Option(help="of integration; default: the scene's own", metavar=_among(METHODS))
]
Step = Annotated[
    str | None, typer.Option(help="fixed step of rk4, time-stepping, exported MJCF, s", metavar="NUMBER")
]
Scheme = Annotated[str | None, typer.Option(help="of time-stepping", metavar=_among(SCHEMES))]
Solver = Annotated[
    str | None, typer.Option(help="friction in time-stepping: exact or relaxed", metavar=_among(SOLVERS))
]
Fallback = Annotated[
    bool | None, typer.Option(help="time-stepping for a while where an event-driven run would end")
]
Values = Annotated[
    list[str] | None,
    typer.Option(
        "--set", help="value of a parameter of the scene, in SI units; repeat it", metavar="NAME=NUMBER"
    ),
]
InputValues = Annotated[
    list[str] | None,
    typer.Option(
        "--input", help="value of an input of the scene, in its unit; repeat it", metavar="NAME=NUMBER"
    ),
]
Estimated = Annotated[
    bool | None,
    typer.Option("--estimate/--no-estimate", help="tell the error of the run by a second, finer run"),
]
RealName = Annotated[
    str | None,
    typer.Option(help="the real type of the library; default: the scene's own", metavar=_among(REALS)),
]
Derivatives = Annotated[bool, typer.Option(help="with derivatives of runs (mg_advance_tangent)")]
MainFile = Annotated[str | None, typer.Option(hidden=True)]  # of versions before `export`
Style = Annotated[str, typer.Option("--format", help="how formulas are written", metavar=_among(STYLES))]
At = Annotated[
    str | None,
    typer.Option(help="where numbers are substituted: a seed, or FILE.json of inputs", metavar="SEED|FILE"),
]
Frames = Annotated[
    str | None,
    typer.Option(help="pictures of the bodies: at the start, a change of mode, and on", metavar="NUMBER"),
]
Verify = Annotated[
    str | None, typer.Option(help="recompute each status on so many configurations", metavar="NUMBER")
]
OutFolder = Annotated[
    Path | None, typer.Option(help="folder for the generated files", metavar="FOLDER", readable=False)
]
OutRun = Annotated[
    Path | None, typer.Option(help="write the run to FILE.npz or FILE.csv", metavar="FILE", readable=False)
]
OutPicture = Annotated[
    Path | None, typer.Option(help="draw the run to FILE.png or FILE.svg", metavar="FILE", readable=False)
]


def read_option(name: str, text: str | None, option: str | None = None) -> Any:
    """The value of `--name`, or of `--option` of the type `name`; None if it was not given. Raises
    ModelgenError where it stands."""
    if text is None:
        return None
    kind, told = TYPES[name], f"--{option or name}"
    try:
        return kind.read(_number(text) if isinstance(kind, Real | Whole) else text, Place(told))
    except SceneError as error:
        remedy = error.remedy or f"leave {told} out for the default"
        raise ModelgenError(error.where, error.found, error.allowed, remedy) from None


def read_values(texts: list[str] | None, option: str) -> dict[str, float]:
    """The values of an option that is written NAME=NUMBER. Raises ModelgenError where it is not, or a name
    comes twice."""
    found: dict[str, float] = {}
    for name, value in named_values(texts, option, "mass=1.2").items():
        try:
            found[name] = NUMBER.read(_number(value), Place(f"{option} {name}"))
        except SceneError as error:
            raise ModelgenError(error.where, error.found, error.allowed, error.remedy) from None
    return found


def named_values(texts: list[str] | None, option: str, example: str) -> dict[str, str]:
    """The texts of an option that is written NAME=TEXT, by name. Raises ModelgenError where it is not, or a
    name comes twice."""
    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name:
            form = f"NAME={'NUMBER' if ':' not in example else 'VALUES'}"
            raise ModelgenError(f"{option} {text}", f"no {form}", "", f"write {option} {example}")
        if name in found:
            raise ModelgenError(f"{option} {text}", f"a second value of {name!r}", "", "leave one out")
        found[name] = value
    return found


def refuse_main(name: str | None) -> None:
    """Raises ModelgenError for `--main`, whose place `export` has taken."""
    if name is not None:
        remedy = "write: modelgen export SCENE --to c --out FOLDER"
        raise ModelgenError("--main", repr(name), "C programs of a run are written by `export`", remedy)


def read_configuration(text: str | None) -> tuple[int, dict[str, Any]]:
    """Seed and given inputs of `--at`. Raises ModelgenError where it is neither a seed nor a JSON object."""
    if text is None or not text.endswith(".json"):
        return (0 if text is None else read_option("at", text)), {}
    try:
        given = json.loads(Path(text).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ModelgenError(f"--at: {text}", f"no JSON: {error}", "an object of inputs") from None
    except OSError as error:
        found, remedy = f"it cannot be read: {error.strerror}", "check the path, or give a seed such as 7"
        raise ModelgenError(f"--at: {text}", found, "a seed, or a JSON file of inputs", remedy) from None
    if not isinstance(given, dict):
        raise ModelgenError(f"--at: {text}", "no JSON object", 'an object such as {"eta": [0.1, 0.2]}')
    return 0, given


def _number(text: str) -> float | str:
    """The number that a text is, or the text, which may be an expression such as 2*pi."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text
