"""The command `new`: a commented scene of a chosen kind, to be run and changed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import click

from modelgen.cli.command import Argument, Option
from modelgen.cli.options import AsJson
from modelgen.cli.output import check_file, print_facts
from modelgen.errors import ModelgenError
from modelgen.file_writing import write_file
from modelgen.name_suggestions import nearest

FOLDER = Path(__file__).parents[1] / "scene" / "templates"

Kind = Annotated[str | None, Argument(metavar="KIND", help="of scene; without it the list of kinds")]
SceneOut = Annotated[
    Path | None,
    Option("--out", "-o", help="file of the scene; default: KIND.toml", metavar="FILE"),
]


def new(kind: Kind = None, out: SceneOut = None, as_json: AsJson = False) -> None:
    """Write a commented scene of a kind, ready to be run and changed, or list the kinds."""
    if kind is None:
        _list_kinds(out, as_json)
        return
    text = template(kind)
    path = Path(f"{kind}.toml") if out is None else out
    if path.suffix != ".toml":
        raise ModelgenError(
            str(path), "no name of a scene file", "NAME.toml", f"write --out {path.stem}.toml"
        )
    if path.exists():
        raise ModelgenError(str(path), "the file is there already", "", "name another one with --out")
    check_file(path)
    write_file(path, text)
    facts: dict[str, Any] = {"kind": kind, "file": str(path)}
    print_facts(facts, as_json, lambda: click.echo(f"written: {path}\nrun it: modelgen simulate {path}"))


def kinds() -> dict[str, str]:
    """What there is to choose from: a line for each kind."""
    found = {}
    for path in sorted(FOLDER.glob("*.toml")):
        name, _, line = path.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ").partition(": ")
        found[name] = line
    return found


def template(kind: str) -> str:
    """The text of a scene. Raises ModelgenError where there is none of that kind."""
    known = kinds()
    if kind not in known:
        found, allowed = "there is no scene of this kind", f"kinds: {', '.join(known)}"
        raise ModelgenError(f"kind {kind!r}", found, allowed, nearest(kind, known))
    return (FOLDER / f"{kind}.toml").read_text(encoding="utf-8")


def _list_kinds(out: Path | None, as_json: bool) -> None:
    known = kinds()
    if out is not None:
        allowed = f"kinds: {', '.join(known)}"
        raise ModelgenError(
            "--out", "no kind of scene is named", allowed, f"write: modelgen new KIND --out {out}"
        )

    def show() -> None:
        width = max(map(len, known))
        for name, line in known.items():
            click.echo(f"{name:{width}}  {line}")
        click.echo("\nmodelgen new KIND writes KIND.toml.")

    print_facts({"kinds": known}, as_json, show)
