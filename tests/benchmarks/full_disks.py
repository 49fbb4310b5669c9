"""Disks that are full: `python -m tests.benchmarks.full_disks bytes|operations|killed|small N [COMMANDS]`.

Each command that writes, at N instants of its writing; afterwards the older files must be as they were, the
message must name the file, and the same command must be right where there is room.

bytes: the disk is full after so many bytes, which a preloaded library counts in `write`, `pwrite`, `writev`.
operations: one of the files or folders cannot be made, linked, renamed or flushed.
killed: the process is killed before such an operation; each file must be whole then, older or new.
small: a file system in memory of so many pages, for output, built files, cache and temporary files, also of
    the compilers that are started (needs the right to mount one in a name space of its own, `unshare -Urm`).
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from modelgen import file_writing
from tests.benchmarks.damaged_files import ROOT, SCENE, keeping_compiler

WHEEL, ROLLING, PENDULUM = (
    ROOT / "scenes" / f"{name}.toml" for name in ("balancing_wheel", "bicycle", "double_pendulum")
)
SHORT = ("--until", "0.1")
LONG = re.compile(r"\S*/\S*|-\S+")  # paths, options of compilers
LONGEST = 400  # other letters of a message
LEFT = re.compile(r"\.modelgen-|\.build-")  # names of what is being written
PAGE = 4096

FAULTS = """#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>
static char under[4096];
static long left = -1, taken, fatal = -1, acts, kills;
void disk_has(const char *folder, long bytes, long operation, long is_killed) {
  strncpy(under, folder, sizeof under - 1);
  left = bytes, taken = 0, fatal = operation, acts = 0, kills = is_killed;
}
long disk_took(void) { return taken; }
long disk_acted(void) { return acts; }
static int is_under(const char *path) { return *under && !strncmp(path, under, strlen(under)); }
static int is_file_under(int file) {
  char name[64], path[4096];
  if (!*under) return 0;
  snprintf(name, sizeof name, "/proc/self/fd/%d", file);
  ssize_t n = readlink(name, path, sizeof path - 1);
  if (n < 0) return 0;
  path[n] = 0;
  return is_under(path);
}
static int fails(void) {
  if (acts++ != fatal) return 0;
  if (kills) kill(getpid(), SIGKILL);
  errno = ENOSPC;
  return 1;
}
static int is_full(int file, size_t *size) {
  if (!is_file_under(file)) return 0;
  if (left >= 0 && taken + (long)*size > left) *size = (size_t)(left - taken);
  taken += (long)*size;
  if (*size) return 0;
  errno = ENOSPC;
  return 1;
}
#define NEXT(result, name, ...) \\
  static result (*next)(__VA_ARGS__); \\
  if (!next) next = (result(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)
ssize_t write(int file, const void *from, size_t size) {
  NEXT(ssize_t, "write", int, const void *, size_t);
  return size && is_full(file, &size) ? -1 : next(file, from, size);
}
ssize_t pwrite(int file, const void *from, size_t size, off_t at) {
  NEXT(ssize_t, "pwrite", int, const void *, size_t, off_t);
  return size && is_full(file, &size) ? -1 : next(file, from, size, at);
}
ssize_t pwrite64(int file, const void *from, size_t size, off_t at) { return pwrite(file, from, size, at); }
ssize_t writev(int file, const struct iovec *parts, int n) {
  for (int k = 0; k < n; k++)
    if (parts[k].iov_len) return write(file, parts[k].iov_base, parts[k].iov_len);
  return 0;
}
#define OPENS(name) \\
  int name(const char *path, int flags, ...) { \\
    va_list more; \\
    va_start(more, flags); \\
    int mode = flags & O_CREAT ? va_arg(more, int) : 0; \\
    va_end(more); \\
    NEXT(int, #name, const char *, int, ...); \\
    return flags & O_CREAT && is_under(path) && fails() ? -1 : next(path, flags, mode); \\
  }
OPENS(open)
OPENS(open64)
int mkdir(const char *path, mode_t mode) {
  NEXT(int, "mkdir", const char *, mode_t);
  return is_under(path) && fails() ? -1 : next(path, mode);
}
int rename(const char *from, const char *to) {
  NEXT(int, "rename", const char *, const char *);
  return is_under(to) && fails() ? -1 : next(from, to);
}
int link(const char *from, const char *to) {
  NEXT(int, "link", const char *, const char *);
  return is_under(to) && fails() ? -1 : next(from, to);
}
int fsync(int file) {
  NEXT(int, "fsync", int);
  return is_file_under(file) && fails() ? -1 : next(file);
}
"""


@dataclass(frozen=True, slots=True)
class Writing:
    """A command that writes; its last word is the file or folder.

    Attributes:
        words: as on the command line.
        there: whether the older result is there before.
        at_once: whether nothing is there before, and all of it or nothing afterwards.
        within: whether it writes into the current folder.
        goes_on: whether a file that is there grows.
        home: whether it writes into the home folder.
    """

    words: tuple[str, ...]
    there: bool = True
    at_once: bool = False
    within: bool = False
    goes_on: bool = False
    home: bool = False


def writing_commands(folder: Path) -> dict[str, Writing]:
    """By name; what they read lies in a folder."""
    scene, wheel, run = str(SCENE), str(WHEEL), str(folder / "run.npz")
    vary = ("sweep", wheel, "--vary", "torque=0:1:6", *SHORT, "--threads", "1")
    knobs = ("--knobs", "tolerance", *SHORT)
    return {
        "simulate .npz": Writing(("simulate", scene, "--out", "run.npz")),
        "simulate .csv": Writing(("simulate", scene, "--out", "run.csv")),
        "simulate .png": Writing(("simulate", scene, "--plot", "run.png")),
        "simulate, first": Writing(("simulate", scene, *SHORT), there=False, within=True),
        "plot .svg": Writing(("plot", run, "--out", "run.svg")),
        "plot .gif": Writing(("plot", str(folder / "short.npz"), "--out", "run.gif")),
        "plot, sweep": Writing(("plot", str(folder / "swept"), "--out", "swept.png")),
        "view": Writing(("view", run, "--out", "run.html")),
        "view, scene": Writing(("view", scene, *SHORT, "--out", "scene.html")),
        "report": Writing(("report", run, "--out", "report.html")),
        "inspect": Writing(("inspect", "sphere-plane", "--format", "html", "--out", "pair.html")),
        "inspect, text": Writing(("inspect", "sphere-plane", "--out", "pair.txt")),
        "import": Writing(("import", str(folder / "model.xml"), "--out", "scene.toml")),
        "new": Writing(("new", "top", "--out", "top.toml"), there=False, at_once=True),
        "new, scenes": Writing(("new", "--scenes", "--out", "scenes"), there=False, at_once=True),
        "export c": Writing(("export", scene, "--to", "c", "--no-figures", "--out", "c")),
        "export c, new": Writing(
            ("export", scene, "--to", "c", "--no-figures", "--out", "cc"), there=False, at_once=True
        ),
        "export fmu": Writing(("export", wheel, "--to", "fmu", "--out", "fmu")),
        "export casadi": Writing(("export", scene, "--to", "casadi", "--out", "casadi")),
        "export mjcf": Writing(("export", scene, "--to", "mjcf", "--out", "mjcf")),
        "export urdf": Writing(("export", str(PENDULUM), "--to", "urdf", "--out", "urdf")),
        "export browser": Writing(("export", scene, "--to", "browser", "--out", "page.html")),
        "build": Writing(("build", scene, "--out", "built"), there=False),
        "build, derivatives": Writing(("build", scene, "--derivatives", "--out", "derived"), there=False),
        "sweep": Writing((*vary, "--out", "swept"), there=False),
        "sweep, whole runs": Writing((*vary, "--keep", "trajectories", "--out", "kept"), there=False),
        "sweep, picture": Writing((*vary, "--out", str(folder / "swept"), "--plot", "swept.svg")),
        "tune": Writing(("tune", scene, "--error", "1e-4", *knobs, "--out", "tuned.toml")),
        "tune, in place": Writing(("tune", "--error", "1e-4", *knobs, "--in-place", "own.toml")),
        "measure": Writing(("measure", scene, *knobs, "--plot", "front.svg")),
        "measure, store": Writing(("measure", scene, "--fresh", *knobs), within=True, goes_on=True),
        "fit": Writing(
            (
                "fit",
                wheel,
                str(folder / "wheel.csv"),
                "--of",
                "axle,lean",
                "--by",
                "torque",
                "--plot",
                "l.svg",
            )
        ),
        "linearise": Writing(("linearise", str(ROLLING), "--vary", "speed=4:8:3", "--plot", "speeds.svg")),
        "sensitivity": Writing(
            ("sensitivity", wheel, "--by", "torque", "--at", "0.1"), there=False, within=True
        ),
        "completion": Writing(("--install-completion",), home=True),
    }


class Told:
    """How a command ended, and what it printed."""

    def __init__(self, words: Sequence[str]) -> None:
        from click.testing import CliRunner

        from modelgen.cli.command_group import app

        answer = CliRunner().invoke(app, list(words))
        self.code, self.text = answer.exit_code, answer.output
        self.is_short = answer.exception is None or isinstance(answer.exception, SystemExit)
        self.is_short = self.is_short and len(LONG.sub("", self.text)) < LONGEST

    def refuses(self, disk: Path, within: bool) -> bool:
        """Whether it says which file cannot be written, and why."""
        named = "generated/" in self.text or str(disk) in self.text if within else str(disk) in self.text
        return self.code == 2 and self.is_short and named and "No space left" in self.text


class Disk:
    """A folder in which writing fails."""

    def __init__(self, folder: Path, library: ctypes.CDLL) -> None:
        self.folder, self.library = folder, library
        for name in ("disk_took", "disk_acted"):
            getattr(library, name).restype = ctypes.c_long

    def has(self, room: int = -1, operation: int = -1, kills: bool = False) -> None:
        """So many bytes from now on, and so many operations before the one that fails; -1: no limit."""
        numbers = (ctypes.c_long(each) for each in (room, operation, kills))
        self.library.disk_has(str(self.folder).encode(), *numbers)

    def heals(self) -> None:
        self.library.disk_has(b"", *(ctypes.c_long(-1),) * 3)

    def is_emptied(self) -> None:
        shutil.rmtree(self.folder)
        self.folder.mkdir()


def of_full_disks(way: str, folder: Path, count: int, only: list[str]) -> Iterator[tuple[str, bool]]:
    """In one process, in which the preloaded library counts bytes and operations."""
    disk = Disk(folder / "disk", ctypes.CDLL(os.environ["LD_PRELOAD"]))
    disk.folder.mkdir()
    prepare(folder)
    for name, writing in writing_commands(folder).items():
        if only and name.partition(",")[0].partition(" ")[0] not in only and name not in only:
            continue
        disk.is_emptied()
        words = begun(writing, folder, disk.folder)
        if name == "tune, in place":
            shutil.copy(SCENE, words[-1])
        firsts = []
        for _ in range(2):
            if not writing.there:
                disk.is_emptied()
                begun(writing, folder, disk.folder)
            disk.has()
            told = Told(words)
            assert told.code == 0, (name, told.text)
            total = disk.library.disk_took() if way == "bytes" else disk.library.disk_acted()
            firsts.append(files(disk.folder))
        whole = firsts[-1]
        older = whole if writing.there else {}
        varying = {path for path in whole if whole[path] != firsts[0].get(path)} - {"measured.jsonl"}
        for number in range(count):
            if not writing.there:
                disk.is_emptied()
                begun(writing, folder, disk.folder)
            at = total * number // count
            if way == "killed":
                right, text = is_whole_after_kill(disk, writing, words, at, older, whole, varying)
            else:
                disk.has(*((at, -1) if way == "bytes" else (-1, at)))
                told = Told(words)
                had_room = (
                    way == "bytes" and disk.library.disk_took() < at
                )  # a sweep writes more when it is slow
                disk.heals()
                now, text = files(disk.folder), f"{told.code} {told.text[-300:]}"
                if told.code == 0 and (way == "operations" or had_room):
                    right = is_as(now, whole, varying)
                elif writing.there:
                    right = told.refuses(disk.folder, writing.within) and grown(now, older, writing.goes_on)
                else:
                    right = told.refuses(disk.folder, writing.within) and not (writing.at_once and now)
                    right = right and Told(words).code == 0 and is_as(files(disk.folder), whole, varying)
                if writing.there and writing.goes_on:
                    older = now
            if not right:
                print(f"{name}, {number}: {text}", flush=True)
            yield name, right


def is_whole_after_kill(
    disk: Disk,
    writing: Writing,
    words: Sequence[str],
    at: int,
    older: Mapping[str, bytes],
    whole: Mapping[str, bytes],
    varying: Collection[str],
) -> tuple[bool, str]:
    """Whether a command that is killed leaves whole files, and the next is right; how it ended."""
    child = os.fork()
    if child == 0:
        disk.has(operation=at, kills=True)
        Told(words)
        os._exit(0)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    now = {path: content for path, content in files(disk.folder).items() if not LEFT.search(path)}
    right = older.keys() <= now.keys() and not (writing.at_once and now and not is_as(now, whole, varying))
    for path, content in now.items():
        same = content in (older.get(path), whole.get(path)) or (
            path in varying and alike(content, whole[path])
        )
        grows = writing.goes_on and content.startswith(older.get(path, b""))
        partial = not writing.there and not writing.at_once and path not in whole  # parts of a table
        right = right and (same or grows or partial)
    file_writing._cleared.clear()  # the next command is a process of its own
    told = Told(words)
    after = files(disk.folder)
    left = [path for path in after if LEFT.search(path)]
    right = right and told.code == 0 and not left and (writing.goes_on or is_as(after, whole, varying))
    return right, f"{code}, then {told.code} {told.text[-200:]} {left}"


def begun(writing: Writing, folder: Path, disk: Path) -> list[str]:
    """The words of a command, in the folder in which it is called."""
    os.environ |= {"HOME": str(disk), "SHELL": "/bin/bash"} if writing.home else {"HOME": str(folder)}
    os.chdir(disk if writing.within else folder)
    if writing.within or writing.home:
        return list(writing.words)
    return [*writing.words[:-1], str(disk / writing.words[-1])]


def prepare(folder: Path) -> None:
    """Make what the commands read."""
    os.environ |= keeping_compiler(folder)
    os.chdir(folder)
    scene, wheel, short = str(SCENE), str(WHEEL), list(SHORT)
    recorded = ["--input", "torque=1.5", *short, "--samples", "10", "--out", "wheel.csv"]
    for words in (
        ["simulate", scene, "--out", "run.npz"],
        ["simulate", scene, *short, "--out", "short.npz"],
        ["simulate", wheel, *recorded],
        ["export", scene, "--to", "mjcf", "--out", "mjcf"],
        ["sweep", wheel, "--vary", "torque=0:1:6", *short, "--threads", "1", "--out", "swept"],
    ):
        told = Told(words)
        assert told.code == 0, told.text
    (model,) = (folder / "mjcf").glob("*.xml")
    shutil.copy(model, folder / "model.xml")


def files(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def is_as(found: Mapping[str, bytes], whole: Mapping[str, bytes], varying: Collection[str]) -> bool:
    """Whether just these files are there, with their content."""
    return found.keys() == whole.keys() and all(
        content == whole[path] or (path in varying and alike(content, whole[path]))
        for path, content in found.items()
    )


def alike(content: bytes, other: bytes) -> bool:
    """Whether files that tell times on the clock are both whole, as far as length and end show."""
    return abs(len(content) - len(other)) < 0.05 * len(other) + 100 and content[-4:] == other[-4:]


def grown(now: Mapping[str, bytes], older: Mapping[str, bytes], goes_on: bool) -> bool:
    """Whether all is as it was; or, where the command goes on, whether nothing is lost."""
    return now == older or (
        goes_on and all(now.get(path, b"").startswith(old) for path, old in older.items())
    )


def of_small_disks(folder: Path, count: int, only: list[str]) -> Iterator[tuple[str, bool]]:
    """Output, built files, cache and temporary files in a file system of so many pages."""
    place = folder / "small"
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "tmpfs", place], check=True)
    prepare(folder)
    commands = writing_commands(folder)
    commands["build, empty cache"] = commands["build"]
    for name, writing in commands.items():
        if only and name.partition(",")[0].partition(" ")[0] not in only and name not in only:
            continue

        def emptied(name: str = name) -> None:
            sized(place, None)
            for each in place.iterdir():
                if each.name != "cache" or name == "build, empty cache":
                    shutil.rmtree(each)
            for own in ("out", "tmp"):
                (place / own).mkdir()

        emptied()
        os.environ |= {"MODELGEN_CACHE": str(place / "cache"), "TMPDIR": str(place / "tmp")}
        tempfile.tempdir = None
        words = begun(writing, place, place / "out")
        if name == "tune, in place":
            shutil.copy(SCENE, words[-1])
        told = Told(words)
        assert told.code == 0, (name, told.text)
        whole = files(place / "out")
        pages = 1
        while True:  # until it is enough
            if not writing.there:
                emptied()
                begun(writing, place, place / "out")
            sized(place, pages)
            if Told(words).code == 0:
                break
            pages *= 2
        for number in range(count):
            if not writing.there:
                emptied()
                begun(writing, place, place / "out")
            older = files(place / "out")
            sized(place, pages * number // count)
            told = Told(words)
            now = files(place / "out")
            sized(place, None)
            if told.code == 0:
                right = now.keys() >= whole.keys()
            else:
                named = str(place) in told.text or "generated/" in told.text
                right = told.code == 2 and told.is_short and named and "No space left" in told.text
                right = right and (not writing.there or grown(now, older, writing.goes_on))
                right = right and Told(words).code == 0 and files(place / "out").keys() == whole.keys()
            if not right:
                print(f"{name}, {number}: {told.code} {told.text[-400:]}", flush=True)
            yield name, right
        os.chdir(folder)
    subprocess.run(["umount", place], check=True)


def sized(place: Path, pages: int | None) -> None:
    """Let a file system have so many free pages; None: enough."""
    room = "1g" if pages is None else str(used(place) + max(pages, 1) * PAGE)
    subprocess.run(["mount", "-o", f"remount,size={room}", place], check=True)


def used(place: Path) -> int:
    found = os.statvfs(place)
    return (found.f_blocks - found.f_bfree) * found.f_frsize


def main() -> None:
    way, count = sys.argv[1], int(sys.argv[2])
    again = [sys.executable, "-m", __spec__.name, *sys.argv[1:]]
    with TemporaryDirectory() as name:
        folder = Path(name).resolve()
        if "LD_PRELOAD" not in os.environ:
            (folder / "faults.c").write_text(FAULTS)
            library = folder / "faults.so"
            flags = ("-O1", "-shared", "-fPIC")
            subprocess.run(["cc", *flags, "-o", library, folder / "faults.c", "-ldl"], check=True)
            apart = ["unshare", "-Urm"] if way == "small" else []
            sys.exit(
                subprocess.run([*apart, *again], env=os.environ | {"LD_PRELOAD": str(library)}).returncode
            )
        study = of_small_disks(folder, count, sys.argv[3:])
        if way != "small":
            study = of_full_disks(way, folder, count, sys.argv[3:])
        cases, right = Counter[str](), Counter[str]()
        for case, is_right in study:
            cases[case] += 1
            right[case] += is_right
            if cases[case] == count:
                print(f"{case:45} {right[case]:4} of {count:4} right", flush=True)
        os.chdir("/")
    print(f"{'all':45} {right.total():4} of {cases.total():4} right")


if __name__ == "__main__":
    main()
