"""The command `export`: a scene as C, FMU, CasADi or JAX functions, MJCF, URDF, or a page that runs it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import click

from modelgen.cli.command import Option
from modelgen.cli.option_reading import read_option, read_values
from modelgen.cli.options import AsJson, Form, RealName, SceneFile, Step, Values
from modelgen.cli.output import print_facts
from modelgen.cli.pipeline import check_folder, derive_scene, read_scene
from modelgen.cli.progress import progress
from modelgen.cli.view import check_page
from modelgen.file_writing import scratch_folder

To = Annotated[
    str | None,
    Option(help="c, fmu, casadi, jax, mjcf, urdf or browser", metavar="FORMAT"),
]
Folder = Annotated[
    Path | None,
    Option(
        help="folder for the files, or the page; default: exported/SCENE",
        metavar="FOLDER|FILE.html",
    ),
]

States = Annotated[bool, Option("--states", help="fmu: states of the bodies as outputs as well")]
Measured = Annotated[
    bool, Option("--figures/--no-figures", help="c: measure flash, RAM, stack and instructions")
]


def export(
    scene: SceneFile,
    to: To = None,
    out: Folder = None,
    real: RealName = None,
    states: States = False,
    figures: Measured = True,
    values: Values = None,
    step: Step = None,
    form: Form = None,
    as_json: AsJson = False,
) -> None:
    """Write a scene for use elsewhere: C, FMU, CasADi or JAX functions, MJCF, URDF, a page that runs it."""
    from modelgen.export.export_formats import PAGES, Choices, check_format, export

    choices = Choices(
        real=read_option("real", real),
        parameters=read_values(values, "--set"),
        figures=figures,
        states=states,
        step=read_option("step", step),
    )
    name = check_format(to, choices)
    what = read_scene(scene, form)
    default = Path("exported") / (f"{what.name}.html" if name in PAGES else what.name)
    target = default if out is None else out
    if name in PAGES:
        check_page(target)
    else:
        check_folder(target, "a folder for the files of the export", "name another: --out FOLDER")
    derivation = derive_scene(what)
    with progress("exporting"), scratch_folder() as scratch:
        written = export(derivation, name, target, scratch, choices)
    facts = {
        "scene": what.name,
        "to": name,
        "files": [str(path) for path in written.files],
        "approximated": list(written.approximated),
        "left_out": list(written.left_out),
    }
    titles = (("written", "files"), ("taken otherwise", "approximated"), ("left out", "left_out"))
    lines = [f"{title}: {each}" for title, key in titles for each in facts[key]]
    print_facts(facts, as_json, lambda: click.echo("\n".join(lines)))
