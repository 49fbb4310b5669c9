"""The command `import`: a file of another program as a scene."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import click

from modelgen.cli.command import Argument, Option
from modelgen.cli.option_reading import read_option
from modelgen.cli.options import AsJson
from modelgen.cli.output import check_file, print_facts
from modelgen.file_writing import write_file

Source = Annotated[Path, Argument(metavar="FILE", help="MJCF or URDF, or the CSV of a profile")]
Out = Annotated[
    Path | None,
    Option(
        "--out",
        "-o",
        help="scene file to write; default: standard output",
        metavar="FILE.toml",
    ),
]
Format = Annotated[
    str | None,
    Option("--format", help="mjcf, urdf or profile; default: by the file itself", metavar="FORMAT"),
]
Key = Annotated[
    str | None, Option("--key", help="mjcf: keyframe to begin with, by name or number", metavar="NAME")
]
Floating = Annotated[bool, Option("--floating", help="urdf: the first link moves freely; else it rests")]
Until = Annotated[str | None, Option("--until", help="end of the run, s; default: 1", metavar="SECONDS")]
Corners = Annotated[
    str | None,
    Option("--corners", help="most corners of a polyhedron that stands for a mesh", metavar="NUMBER"),
]
As = Annotated[
    str | None,
    Option("--as", help="shape of a profile: revolution, profile_wall or extrusion", metavar="SHAPE"),
]
Columns = Annotated[
    str | None, Option("--columns", help="of a profile, by name or number; default: 1,2", metavar="A,B")
]
Unit = Annotated[str, Option("--unit", help="of a profile", metavar="[m|cm|mm|um|in]")]
Off = Annotated[
    str | None,
    Option(
        "--tolerance",
        help="by which points may lie off, on average, m; default: their noise",
        metavar="NUMBER",
    ),
]
Length = Annotated[str | None, Option("--length", help="of a wall or an extrusion, m", metavar="NUMBER")]
Without = Annotated[
    str | None, Option("--without", help="parts of the file that may be left out", metavar="A,B,...")
]


def import_file(
    file: Source,
    out: Out = None,
    format: Format = None,
    key: Key = None,
    floating: Floating = False,
    until: Until = None,
    corners: Corners = None,
    without: Without = None,
    kind: As = None,
    columns: Columns = None,
    unit: Unit = "m",
    tolerance: Off = None,
    length: Length = None,
    as_json: AsJson = False,
) -> None:
    """Write the scene of a file of another program: MJCF, URDF, or a measured profile."""
    from modelgen.importing.import_formats import import_scene

    if out is not None:
        check_file(out)
    given: dict[str, Any] = {
        "key": key,
        "floating": floating,
        "until": read_option("until", until),
        "corners": read_option("corners", corners),
        "without": None if without is None else [each.strip() for each in without.split(",") if each.strip()],
        "kind": kind,
        "columns": columns,
        "unit": unit,
        "tolerance": read_option("tolerance", tolerance),
        "length": read_option("length", length),
    }
    found = import_scene(file, format, **{key: value for key, value in given.items() if value is not None})
    if out is not None:
        write_file(out, found.text)
    facts = {
        "scene": found.scene.name,
        "file": None if out is None else str(out),
        "text": found.text if out is None else None,
        "approximated": list(found.approximated),
        "left_out": list(found.left_out),
    }
    print_facts(facts, as_json, lambda: _print(facts))


def _print(facts: dict[str, Any]) -> None:
    if facts["text"] is not None:
        click.echo(facts["text"], nl=False)
        return
    click.echo(f"written: {facts['file']}")
    for title, key in (("taken otherwise", "approximated"), ("left out", "left_out")):
        for sentence in facts[key]:
            click.echo(f"{title}: {sentence}")
