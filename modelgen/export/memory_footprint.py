"""What a scene needs on a small machine: flash, RAM, stack and instructions, as far as measured."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from modelgen.benchmark.callgrind_counts import counted, why_not_counted
from modelgen.codegen.amalgamation import header_text
from modelgen.codegen.compiler import first_error, run_program
from modelgen.errors import ModelgenError
from modelgen.export.scene_header_and_tables import source
from modelgen.file_writing import scratch_folder

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno")
APART = ("-ffunction-sections", "-fdata-sections")
UNITS, OBJECTS = ("scene.c", "modelgen_runtime.c"), ("scene.o", "modelgen_runtime.o")
NO_SIZES = "binutils are not installed: no sizes of code"
EVALUATIONS = 100  # of the right-hand side that are counted


@dataclass(frozen=True, slots=True)
class Footprint:
    """Bytes and instructions; None where they were not measured.

    Attributes:
        machine: compiler and processor for which they hold.
        flash: code and constants of a program.
        instance, work, iwork: of one run, of which scratch memory of numbers and of integers.
        stack: deepest chain of calls by name or pointer; a lower bound if `recursive`.
        recursive: names of functions that call themselves.
        evaluation: instructions of one evaluation of the right-hand side at the start.
        why: why something was not measured.
    """

    machine: str
    flash: tuple[int, int] | None
    instance: int
    work: int
    iwork: int
    stack: int | None
    recursive: tuple[str, ...]
    evaluation: int | None
    why: tuple[str, ...]


def footprint_of(files: Mapping[str, str], defines: tuple[str, ...]) -> Footprint | None:
    """The figures of an exported folder, given as texts; None without gcc.

    Raises ModelgenError where gcc, or what it has made, fails.
    """
    gcc = shutil.which("gcc")
    if gcc is None:
        return None
    with scratch_folder() as folder:
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
        for file in ("footprint_sizes.c", "footprint_link.c"):
            (folder / file).write_text(source(file), encoding="utf-8")
        tools = _Tools(gcc, folder, defines)
        tools.compile("-c", *APART, "-fcallgraph-info=su", *UNITS)
        missing = (why_not_counted(), "" if shutil.which("size") else NO_SIZES)
        return Footprint(
            tools.machine(),
            tools.flash() if shutil.which("size") else None,
            *tools.sizes(),
            *tools.stack(),
            tools.evaluation(),
            tuple(filter(None, missing)),
        )


@dataclass(frozen=True, slots=True)
class _Tools:
    gcc: str
    folder: Path
    defines: tuple[str, ...]

    def machine(self) -> str:
        words = [self._said([self.gcc, flag]) for flag in ("-dumpfullversion", "-dumpmachine")]
        return f"gcc {words[0]}, {words[1]}"

    def flash(self) -> tuple[int, int]:
        """Code and constants, bytes, of a program that begins, advances and senses."""
        self.compile("-Wl,--gc-sections", "footprint_link.c", *OBJECTS, "-lm", "-o", "used")
        table = self._said(["size", "-A", "used"])
        parts = {found[1]: int(found[2]) for found in re.finditer(r"^(\.\S+)\s+(\d+)", table, re.MULTILINE)}
        return parts.get(".text", 0), parts.get(".rodata", 0) + parts.get(".data.rel.ro", 0)

    def sizes(self) -> tuple[int, int, int]:
        """Bytes of an instance, and of its scratch memory."""
        self.compile(f"-DEVALUATIONS={EVALUATIONS}", "footprint_sizes.c", *OBJECTS, "-lm", "-o", "probe")
        whole, work, iwork = map(int, self._said([str(self.folder / "probe")]).split())
        return whole, work, iwork

    def evaluation(self) -> int | None:
        """Instructions of one evaluation of the right-hand side, by the probe that `sizes` has made."""
        found = counted([str(self.folder / "probe"), "count"], "mg_evaluate")
        return None if found is None else found // EVALUATIONS

    def stack(self) -> tuple[int | None, tuple[str, ...]]:
        """Bytes of the deepest chain of calls from scene_begin, scene_advance or scene_sense."""
        graph = _Graph()
        for path in sorted(self.folder.glob("*.ci")):
            graph.read(path.read_text(encoding="utf-8"))
        if not graph.bytes:
            return None, ()
        depth = max(graph.depth(name) for name in ("scene_begin", "scene_advance", "scene_sense"))
        return depth, tuple(sorted(graph.recursive))

    def compile(self, *words: str) -> None:
        """Run gcc on files of the folder."""
        self._said([self.gcc, *FLAGS, *self.defines, *words])

    def _said(self, command: list[str]) -> str:
        done = run_program(command, self.folder)
        if done.returncode:
            found = f"it ended with {done.returncode}: {first_error(done) or done.stderr.strip()}"
            raise ModelgenError(shlex.join(command), found, "", "export with --no-figures")
        return done.stdout.strip()


class _Graph:
    """Which function calls which, with the bytes of their frames, as gcc tells.

    A call through a pointer may reach every function of which only the address is taken.
    """

    def __init__(self) -> None:
        self.bytes: dict[str, int] = {}
        self.calls: dict[str, set[str]] = {}
        self.recursive: set[str] = set()
        self._depth: dict[str, int] = {}
        self._open: list[str] = []

    def read(self, text: str) -> None:
        for title, label in re.findall(r'node: \{ title: "([^"]*)" label: "([^"]*)"', text):
            if found := re.search(r"\\n(\d+) bytes", label):
                self.bytes[_plain(title)] = int(found[1])
        for caller, target in re.findall(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"', text):
            self.calls.setdefault(_plain(caller), set()).add(_plain(target))

    def depth(self, name: str) -> int:
        """Bytes from this function down; a function that is open already is not entered again."""
        if name not in self._depth:
            self._open.append(name)
            direct = self.calls.get(name, set())
            self.recursive |= direct & set(self._open)
            targets = (direct | (self._by_pointer() if INDIRECT in direct else set())) - set(self._open)
            below = [self.depth(each) for each in sorted(targets)]
            self._open.pop()
            self._depth[name] = self.bytes.get(name, 0) + max(below, default=0)
        return self._depth[name]

    def _by_pointer(self) -> set[str]:
        called = {target for each in self.calls.values() for target in each}
        return {each for each in set(self.bytes) - called - PUBLIC if not each.startswith("scene_")}


INDIRECT = "__indirect_call"
PUBLIC = frozenset(re.findall(r"^MG_API [^;(]*?(\w+)\(", header_text(), re.MULTILINE))


def _plain(title: str) -> str:
    """The name of a function, without the file that gcc puts before that of a static one."""
    return title.rpartition(":")[2]
