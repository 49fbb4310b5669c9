"""Damaged and planted files: `python -m tests.benchmarks.damaged_files libraries|caches|planted [N]`.

libraries N: N times a built library is damaged, and the next command must give what it gave before.
caches N: the same of the cache folder: core, seal, key, a folder in the way, what a killed build left.
planted: libraries that somebody else built lie where those of the scene do; their constructors must not run.
"""

from __future__ import annotations

import ctypes
import json
import os
import random
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "bouncing_ball.toml"
COMMANDS = (("simulate", "--until", "0.5", "--json"), ("build", "--json"))
MOST_S = 600.0  # on a machine that has much else to do

# a compiler that keeps what it has compiled, so that a study of damages takes little time
KEEPING = """#!/bin/sh
case "$*" in *--version*) exec cc --version;; esac
last=; rest=
for word in "$@"; do test "$last" = -o && out="$word" || rest="$rest $word"; last="$word"; done
kept="$KEPT/$( (cat ./*.c ./*.h; echo "$rest") | md5sum | cut -c1-32)"
test -f "$kept" || { cc "$@" || exit; cp "$out" "$kept"; exit; }
cp "$kept" "$out"
"""

PLANTED = """#include <stdio.h>
__attribute__((constructor)) static void run(void) {{ FILE *f = fopen("{mark}", "w"); if (f) fclose(f); }}
"""


def damaged(content: bytes, kind: str, draw: random.Random) -> bytes:
    """What is left of a file."""
    at = draw.randrange(len(content))
    match kind:
        case "cut":
            return content[:at]
        case "zeros from there on":
            return content[:at] + bytes(len(content) - at)
        case "a page of noise":
            return content[:at] + draw.randbytes(4096) + content[at + 4096 :]
        case "noise":
            return draw.randbytes(len(content))
        case "another file":
            return Path(sys.executable).read_bytes()[:200_000]
        case "longer":
            return content + draw.randbytes(1 + at)
    flipped = bytearray(content)
    for _ in range(20):
        flipped[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
    return bytes(flipped)


KINDS = ("cut", "zeros from there on", "a page of noise", "noise", "another file", "longer", "flipped bits")


def keeping_compiler(folder: Path) -> dict[str, str]:
    """The environment in which a compiler in a folder, which keeps what it has compiled, is used."""
    kept, compiler = folder / "kept", folder / "cc"
    kept.mkdir()
    compiler.write_text(KEEPING)
    compiler.chmod(0o755)
    return {"CC": str(compiler), "KEPT": str(kept)}


class Place:
    """A folder with a cache and a compiler of its own, and what the commands answer there."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.cache, self.built = folder, folder / "cache", folder / "generated" / SCENE.stem
        own = {"MODELGEN_CACHE": str(self.cache), "PYTHONPATH": str(ROOT)}
        self.environment = os.environ | keeping_compiler(folder) | own
        self.right = {command: self.answer(command) for command in COMMANDS}

    def answer(self, command: tuple[str, ...]) -> Any:
        """What a command prints, without times; how it ended where that is not well."""
        name, *options = command
        words = [sys.executable, "-m", "modelgen", name, str(SCENE), *options]
        told = subprocess.run(
            words,
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=MOST_S,
            check=False,
        )
        if told.returncode or "Traceback" in told.stderr:
            return f"exit code {told.returncode}: {told.stderr[-200:]}"
        return {key: value for key, value in json.loads(told.stdout).items() if key != "wall_s"}

    @property
    def library(self) -> Path:
        (path,) = self.built.glob("*.so")
        return path

    @property
    def core(self) -> Path:
        (path,) = self.cache.glob("runtime-*.o")
        return path


def of_libraries(place: Place, count: int) -> Iterator[tuple[str, bool]]:
    draw = random.Random(50)
    whole = place.library.read_bytes()
    for number in range(count):
        kind, command = KINDS[number % len(KINDS)], COMMANDS[number // len(KINDS) % len(COMMANDS)]
        place.library.write_bytes(damaged(whole, kind, draw))
        right = place.answer(command) == place.right[command]
        yield f"{command[0]} after: {kind}", right and place.library.read_bytes() == whole


def of_caches(place: Place, count: int) -> Iterator[tuple[str, bool]]:
    draw = random.Random(50)
    for number in range(count):
        kind = KINDS[number % len(KINDS)]
        hurt = ("core", "seal", "key", "folder in the way", "left by a killed build", "emptied")[number % 6]
        path = {"seal": Path(f"{place.core}.seal"), "key": place.cache / "key"}.get(hurt, place.core)
        if hurt == "emptied":
            shutil.rmtree(place.cache)
        elif hurt == "left by a killed build":
            scratch = place.cache / f".build-{path.name}"
            scratch.mkdir()
            (scratch / path.name).write_bytes(damaged(path.read_bytes(), kind, draw))
            path.unlink()
        elif hurt == "folder in the way":
            path.unlink()
            path.mkdir()
        else:
            path.write_bytes(damaged(path.read_bytes(), kind, draw))
        shutil.rmtree(place.built)
        right = place.answer(COMMANDS[0]) == place.right[COMMANDS[0]]
        yield f"simulate after: {hurt}", right and not list(place.cache.glob(".build-*"))


def of_planted(place: Place, _: int) -> Iterator[tuple[str, bool]]:
    mark, source = place.folder / "mark", place.folder / "planted.c"
    source.write_text(PLANTED.format(mark=mark))
    planted = place.folder / "planted.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", planted, source], check=True)
    ctypes.CDLL(str(planted))
    loads = mark.exists()  # it does what it is to do
    mark.unlink(missing_ok=True)
    seal = (
        "import sys, pathlib; from modelgen.codegen.built_files import seal; seal(pathlib.Path(sys.argv[1]))"
    )
    foreign = place.environment | {"MODELGEN_CACHE": str(place.folder / "other")}
    for command in COMMANDS:
        for way in ("over the library", "with the seal of another user", "without a seal", "as a link"):
            path = place.library
            path.unlink()
            if way == "as a link":
                path.symlink_to(planted)
            else:
                shutil.copy(planted, path)
            if way == "with the seal of another user":
                subprocess.run([sys.executable, "-c", seal, path], env=foreign, check=True)
            if way == "without a seal":
                Path(f"{path}.seal").unlink()
            right = place.answer(command) == place.right[command]
            yield f"{command[0]}, planted {way}", loads and right and not mark.exists()


def main() -> None:
    what, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 0
    with TemporaryDirectory() as name:
        folder = Path(name).resolve()
        study = {"libraries": of_libraries, "caches": of_caches, "planted": of_planted}[what]
        found = study(Place(folder), count)
        cases, right = Counter[str](), Counter[str]()
        for case, is_right in found:
            cases[case] += 1
            right[case] += is_right
    for case, number in cases.items():
        print(f"{case:45} {right[case]:4} of {number:4} right")
    print(f"{'all':45} {right.total():4} of {cases.total():4} right")


if __name__ == "__main__":
    main()
