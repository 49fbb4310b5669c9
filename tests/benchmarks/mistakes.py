"""Mistakes that people make in scene files, with what is printed.

Run with `python -m tests.benchmarks.mistakes`.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from modelgen import read, require
from modelgen.errors import SceneError
from modelgen.scene.read import read_text
from tests.scene.mistakes import REFUSED, WARNED, written


def main() -> None:
    for mistake in (*REFUSED, *WARNED):
        try:
            answers = [f"warning: {text}" for text in require(read_text(mistake.text, "scene.toml")).warnings]
        except SceneError as refused:
            answers = [str(refused)]
        print(mistake.name, *answers, sep="\n    ")
    with TemporaryDirectory() as folder:
        files = list(written(Path(folder)))
        for name, path, _ in files:
            try:
                read(path)
            except SceneError as refused:
                print(name, str(refused).replace(folder, "here"), sep="\n    ")
    print(f"{len(REFUSED) + len(WARNED) + len(files)} mistakes")


if __name__ == "__main__":
    main()
