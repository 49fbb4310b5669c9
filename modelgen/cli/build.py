"""The command `build`: the compiled library of a scene."""

from __future__ import annotations

import click

from modelgen.cli.option_reading import read_option, refuse_main
from modelgen.cli.options import AsJson, Derivatives, Form, MainFile, OutFolder, RealName, SceneFile
from modelgen.cli.output import print_facts
from modelgen.cli.pipeline import build_scene, folder_of, read_scene


def build(
    scene: SceneFile,
    out: OutFolder = None,
    real: RealName = None,
    form: Form = None,
    main: MainFile = None,
    derivatives: Derivatives = False,
    as_json: AsJson = False,
) -> None:
    """Generate and compile the library of a scene; compiles nothing that is already there."""
    refuse_main(main)
    what = read_scene(scene, form)
    library = build_scene(what, out or folder_of(what, form), read_option("real", real), derivatives)
    manifest = library.manifest
    facts = {
        "scene": manifest.instance["name"],
        "library": str(library.path),
        "real": library.real,
        "hash": library.record.hash,
        "instructions": {name: entry["instructions"] for name, entry in manifest.functions.items()},
    }
    print_facts(facts, as_json, lambda: click.echo(library.path))
