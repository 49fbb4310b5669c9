"""Damage and full disks: `python -m tests.benchmarks.damaged_files libraries|caches|planted|disk [N]`.

libraries N: N times a built library is damaged, and the next command must give what it gave before.
caches N: the same of the cache folder: core, seal, key, a folder in the way, what a killed build left.
planted: libraries that somebody else built lie where those of the scene do; their constructors must not run.
disk N [COMMANDS]: each writing command on a disk that is full after so many bytes, at N instants: the older
files must be as they were, and the message must name the file. Bytes are counted in `write`, `pwrite` and
`writev` of a preloaded library.
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
MOST_S = 120.0

# a compiler that keeps what it has compiled, so that a study of damages takes little time
KEEPING = """#!/bin/sh
case "$*" in *--version*) exec cc --version;; esac
kept="$KEPT/$( (cat ./*.c ./*.h; echo "$*") | md5sum | cut -c1-32)"
last=; for word in "$@"; do test "$last" = -o && out="$word"; last="$word"; done
test -f "$kept" || { cc "$@" || exit; cp "$out" "$kept"; exit; }
cp "$kept" "$out"
"""

PLANTED = """#include <stdio.h>
__attribute__((constructor)) static void run(void) {{ FILE *f = fopen("{mark}", "w"); if (f) fclose(f); }}
"""

FULL = """#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>
static char under[4096];
static long left = -1, taken;
void disk_has(const char *folder, long bytes) {
  strncpy(under, folder, sizeof under - 1);
  left = bytes, taken = 0;
}
long disk_took(void) { return taken; }
static int is_full(int file, size_t *size) {
  char name[64], path[4096];
  if (!*under) return 0;
  snprintf(name, sizeof name, "/proc/self/fd/%d", file);
  ssize_t n = readlink(name, path, sizeof path - 1);
  if (n < 0) return 0;
  path[n] = 0;
  if (strncmp(path, under, strlen(under))) return 0;
  if (left >= 0 && taken + (long)*size > left) *size = (size_t)(left - taken);
  taken += (long)*size;
  if (*size) return 0;
  errno = ENOSPC;
  return 1;
}
ssize_t write(int file, const void *from, size_t size) {
  static ssize_t (*next)(int, const void *, size_t);
  if (!next) next = (ssize_t(*)(int, const void *, size_t))dlsym(RTLD_NEXT, "write");
  return size && is_full(file, &size) ? -1 : next(file, from, size);
}
ssize_t pwrite(int file, const void *from, size_t size, off_t at) {
  static ssize_t (*next)(int, const void *, size_t, off_t);
  if (!next) next = (ssize_t(*)(int, const void *, size_t, off_t))dlsym(RTLD_NEXT, "pwrite");
  return size && is_full(file, &size) ? -1 : next(file, from, size, at);
}
ssize_t pwrite64(int file, const void *from, size_t size, off_t at) { return pwrite(file, from, size, at); }
ssize_t writev(int file, const struct iovec *parts, int n) {
  for (int k = 0; k < n; k++)
    if (parts[k].iov_len) return write(file, parts[k].iov_base, parts[k].iov_len);
  return 0;
}
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


class Place:
    """A folder with a cache and a compiler of its own, and what the commands answer there."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.cache, self.built = folder, folder / "cache", folder / "generated" / SCENE.stem
        kept = folder / "kept"
        kept.mkdir()
        compiler = folder / "cc"
        compiler.write_text(KEEPING)
        compiler.chmod(0o755)
        own = {
            "CC": str(compiler),
            "KEPT": str(kept),
            "MODELGEN_CACHE": str(self.cache),
            "PYTHONPATH": str(ROOT),
        }
        self.environment = os.environ | own
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


def of_full_disks(folder: Path, count: int, only: list[str]) -> Iterator[tuple[str, bool]]:
    """In one process, in which the preloaded library counts the bytes."""
    from click.testing import CliRunner

    from modelgen.cli.command_group import app

    def told(words: list[str]) -> Any:
        return CliRunner().invoke(app, words)

    disk, library = folder / "disk", ctypes.CDLL(os.environ["LD_PRELOAD"])
    library.disk_took.restype = ctypes.c_long
    disk.mkdir()
    os.chdir(folder)
    scene, run = str(SCENE), str(folder / "run.npz")
    assert told(["simulate", scene, "--out", run]).exit_code == 0
    assert told(["export", scene, "--to", "mjcf", "--out", str(folder / "mjcf")]).exit_code == 0
    wheel, rolling = (str(ROOT / "scenes" / f"{name}.toml") for name in ("balancing_wheel", "bicycle"))
    short = ["--until", "0.1"]
    recorded = ["--input", "torque=1.5", *short, "--samples", "10", "--out", "wheel.csv"]
    assert told(["simulate", wheel, *recorded]).exit_code == 0
    (model,) = (folder / "mjcf").glob("*.xml")
    commands = {
        "simulate .npz": ["simulate", scene, "--out", "run.npz"],
        "simulate .csv": ["simulate", scene, "--out", "run.csv"],
        "simulate .png": ["simulate", scene, "--plot", "run.png"],
        "plot .svg": ["plot", run, "--out", "run.svg"],
        "plot .gif": ["plot", run, "--out", "run.gif"],
        "view": ["view", run, "--out", "run.html"],
        "report": ["report", run, "--out", "report.html"],
        "inspect": ["inspect", "sphere-plane", "--format", "html", "--out", "pair.html"],
        "import": ["import", str(model), "--out", "scene.toml"],
        "export c": ["export", scene, "--to", "c", "--no-figures", "--out", "c"],
        "export mjcf": ["export", scene, "--to", "mjcf", "--out", "mjcf"],
        "build": ["build", scene, "--out", "built"],
        "sweep": ["sweep", wheel, "--vary", "torque=0:1:6", *short, "--threads", "1", "--out", "swept"],
        "sweep, whole runs": [
            *("sweep", wheel, "--vary", "torque=0:1:3", *short, "--keep", "trajectories", "--threads", "1"),
            *("--out", "kept"),
        ],
        "tune": ["tune", scene, "--error", "1e-4", "--knobs", "tolerance", *short, "--out", "tuned.toml"],
        "measure": ["measure", scene, "--knobs", "tolerance", *short, "--plot", "front.svg"],
        "measure, store": ["measure", scene, "--fresh", "--knobs", "tolerance", *short],
        "fit": ["fit", wheel, "wheel.csv", "--of", "axle,lean", "--by", "torque", "--plot", "left.svg"],
        "linearise": ["linearise", rolling, "--vary", "speed=4:8:3", "--plot", "speeds.svg"],
    }
    made_anew = ("build", "sweep", "sweep, whole runs")  # where the older result is kept, nothing is written
    for name, words in commands.items():
        if only and name.partition(",")[0].partition(" ")[0] not in only:
            continue
        if name == "measure, store":  # in the folder in which the scene is built
            os.chdir(disk)
            told(words)
        else:
            os.chdir(folder)
            words = [*words[:-1], str(disk / words[-1])]
        library.disk_has(str(disk).encode(), ctypes.c_long(-1))
        answer = told(words)
        assert answer.exit_code == 0, (name, answer.output)
        total, whole, older = library.disk_took(), files(disk), files(disk)
        for number in range(count):
            if name in made_anew:
                shutil.rmtree(words[-1])
                older = files(disk)
            library.disk_has(str(disk).encode(), ctypes.c_long(total * number // count))
            answer = told(words)
            library.disk_has(b"", ctypes.c_long(-1))
            same = files(disk) == older
            if name in made_anew:
                same = told(words).exit_code == 0 and all(is_as(files(disk), each) for each in (whole, older))
            elif name == "measure, store":
                same = all(files(disk)[path].startswith(content) for path, content in older.items())
            names_it = str(disk) in answer.output and "No space left" in answer.output
            yield name, answer.exit_code == 2 and same and names_it
            if not (answer.exit_code == 2 and same and names_it):
                print(name, number, answer.exit_code, same, answer.output[-300:], answer.exception)


def is_as(found: dict[str, bytes], expected: dict[str, bytes]) -> bool:
    """Whether files are there, and hold what is expected, but for runs, which tell times on the clock."""
    return all(
        path in found and (path.endswith(".npz") or found[path] == expected[path]) for path in expected
    )


def files(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def main() -> None:
    what, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 0
    with TemporaryDirectory() as name:
        folder = Path(name).resolve()
        if what == "disk" and "LD_PRELOAD" not in os.environ:
            (folder / "full.c").write_text(FULL)
            preloaded = folder / "full.so"
            subprocess.run(
                ["cc", "-O1", "-shared", "-fPIC", "-o", preloaded, folder / "full.c", "-ldl"], check=True
            )
            own = os.environ | {"LD_PRELOAD": str(preloaded)}
            sys.exit(subprocess.run([sys.executable, "-m", __spec__.name, *sys.argv[1:]], env=own).returncode)
        if what == "disk":
            found = of_full_disks(folder, count, sys.argv[3:])
        else:
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
