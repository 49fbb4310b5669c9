"""The command `new`: a commented scene of a chosen kind, or a shipped one, to be run and changed."""

from __future__ import annotations

import re
from itertools import takewhile
from pathlib import Path
from typing import Annotated, Any

import click

from modelgen.cli.command import Argument, Option
from modelgen.cli.options import AsJson
from modelgen.cli.output import check_file, print_facts
from modelgen.cli.pipeline import check_folder
from modelgen.errors import ModelgenError
from modelgen.file_writing import write_file, write_files
from modelgen.name_suggestions import nearest

PACKAGE = Path(__file__).parents[1]
TEMPLATES = PACKAGE / "scene" / "templates"

Name = Annotated[
    str | None,
    Argument(metavar="NAME", help="a kind of scene or a shipped scene; without it the list of both"),
]
Out = Annotated[
    Path | None,
    Option("--out", "-o", help="file of the scene; default: NAME.toml; of --scenes a folder", metavar="PATH"),
]
All = Annotated[
    bool,
    Option("--scenes", help="all shipped scenes, into the folder scenes/; files that are there stay"),
]


def new(name: Name = None, out: Out = None, scenes: All = False, as_json: AsJson = False) -> None:
    """Write a commented scene of a kind, or a shipped scene, ready to be run and changed; or list them."""
    if scenes:
        _write_scenes(name, Path("scenes") if out is None else out, as_json)
        return
    if name is None:
        _list_names(out, as_json)
        return
    text = template(name)
    path = Path(f"{name}.toml") if out is None else out
    if path.suffix != ".toml":
        raise ModelgenError(
            str(path), "no name of a scene file", "NAME.toml", f"write --out {path.stem}.toml"
        )
    if path.exists():
        raise ModelgenError(str(path), "the file is there already", "", "name another one with --out")
    check_file(path)
    write_file(path, text)
    facts: dict[str, Any] = {"name": name, "file": str(path)}
    print_facts(facts, as_json, lambda: click.echo(f"written: {path}\nrun it: modelgen simulate {path}"))


def kinds() -> dict[str, str]:
    """The kinds of scenes to start from: a line for each."""
    found = {}
    for path in sorted(TEMPLATES.glob("*.toml")):
        name, _, line = path.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ").partition(": ")
        found[name] = line
    return found


def shipped() -> dict[str, Path]:
    """The files of the shipped scenes by name: in an installed package its own folder `scenes`, in a
    clone the folder beside the package."""
    folder = next(place / "scenes" for place in (PACKAGE, PACKAGE.parent) if (place / "scenes").is_dir())
    files = sorted(folder.glob("*.toml"))
    return {path.stem: path for path in files if not path.stem.endswith("_tuned")}  # written by `tune`


def template(name: str) -> str:
    """The text of a scene of a kind, or of a shipped one. Raises ModelgenError where there is none."""
    files = {kind: TEMPLATES / f"{kind}.toml" for kind in kinds()} | shipped()
    if name not in files:
        allowed = "`modelgen new` lists the kinds and the shipped scenes"
        raise ModelgenError(
            f"scene {name!r}", "there is no kind or shipped scene of this name", allowed, nearest(name, files)
        )
    return files[name].read_text(encoding="utf-8")


def first_sentence(path: Path) -> str:
    """The first sentence of the comment that opens a scene."""
    comment = takewhile(lambda line: line.startswith("#"), path.read_text(encoding="utf-8").splitlines())
    return re.split(r"(?<=\.) ", " ".join(line[1:].strip() for line in comment))[0]


def _write_scenes(name: str | None, folder: Path, as_json: bool) -> None:
    if name is not None:
        raise ModelgenError("--scenes", f"the scene {name!r} is named beside it", "", "leave one of them out")
    check_folder(folder, "a folder for the scenes", "name another one: --out FOLDER")
    copies = {folder / path.name: path for path in shipped().values()}
    missing = {copy: path.read_text(encoding="utf-8") for copy, path in copies.items() if not copy.exists()}
    write_files(missing)
    facts = {"folder": str(folder), "written": len(missing), "kept": len(copies) - len(missing)}
    print_facts(
        facts,
        as_json,
        lambda: click.echo(f"{folder}: {facts['written']} scenes written, {facts['kept']} were there"),
    )


def _list_names(out: Path | None, as_json: bool) -> None:
    if out is not None:
        allowed = "a kind of scene or a shipped scene, as `modelgen new` lists them"
        raise ModelgenError("--out", "no scene is named", allowed, f"write: modelgen new NAME --out {out}")
    scenes = {name: first_sentence(path) for name, path in shipped().items()}

    def show() -> None:
        for title, lines in (("kinds of scenes to start from", kinds()), ("shipped scenes", scenes)):
            width = max(map(len, lines))
            click.echo(f"{title}:")
            for name, line in lines.items():
                click.echo(f"  {name:{width}}  {line}")
            click.echo()
        click.echo("modelgen new NAME writes NAME.toml; modelgen new --scenes writes all shipped scenes.")

    print_facts({"kinds": kinds(), "scenes": scenes}, as_json, show)
