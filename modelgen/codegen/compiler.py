"""The C compiler of this machine: which one, its flags, and how C text becomes a shared library."""

from __future__ import annotations

import importlib.util
import os
import platform
import re
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from modelgen.codegen.built_files import put
from modelgen.codegen.library import REAL_FLAGS
from modelgen.errors import CompilerMissing, LibraryError, install

KILLED_S = 1.0  # s, longest wait for programs that were killed
CANDIDATES = ("cc", "gcc", "clang")
LEVELS, LEVEL = ("O1", "O2", "O3"), "O2"
FLAGS = ("-std=c99", "-fno-math-errno", "-ffp-contract=off", "-fvisibility=hidden", "-fPIC")
# two passes of GCC that take a tenth of its time on the core, and change no run by more than 2 %
QUICK_GCC = ("-fno-gcse", "-fno-schedule-insns2")
SHARED = ("-shared", *(("-Wl,-z,defs",) if sys.platform == "linux" else ()))
LIBRARIES = ("-lm",)
DEBUG = "MODELGEN_DEBUG_CORE"  # environment variable: builds a core that asserts its preconditions
FILLS = ("1", "2", "3", "4", "5")  # its values: patterns of memory; 1: NaN and -1
IS_X86 = platform.machine().lower() in ("x86_64", "amd64")
# with AVX-512, or tuned for it, GCC 12 copies so that the core stalls: a third slower; with FMA it fuses
# products and sums of vectors although it is not to contract, so that bits differ from those of other builds
NATIVE = ("-march=native", *(("-mno-avx512f", "-mno-fma", "-mtune=generic") if IS_X86 else ()))
BASELINE = "-mcpu=baseline"  # tells Zig not to compile for this processor, as it does if nothing is said


@dataclass(frozen=True, slots=True)
class Compiler:
    """A command that compiles C, and its version."""

    command: tuple[str, ...]
    version: str  # what --version prints

    @property
    def is_zig(self) -> bool:
        """Found by trial, since a script may call it: Zig alone knows the processor `baseline`."""
        return not self.is_gcc and takes(self.command, BASELINE)

    @property
    def is_gcc(self) -> bool:
        return "Free Software Foundation" in self.version

    def flags(self, real: str, level: str = LEVEL) -> tuple[str, ...]:
        """All flags that decide what an object does, for one real type and level of optimisation."""
        native = ("-fno-sanitize=undefined",) if self.is_zig else NATIVE  # zig targets this CPU anyway
        quick = QUICK_GCC if self.is_gcc else ()
        return (f"-{level}", *FLAGS, *quick, *native, *REAL_FLAGS[real], *self._debug_flags())

    def _debug_flags(self) -> tuple[str, ...]:
        """The flags of the debug core, if DEBUG asks for it: assertions, which Zig drops from optimised code
        unless told otherwise, and memory filled before use; local variables too if the compiler can."""
        fill = os.environ.get(DEBUG, "")
        if not fill:
            return ()
        if fill not in FILLS:
            raise LibraryError(
                DEBUG, repr(fill), f"allowed: {', '.join(FILLS)}, or nothing", "correct or unset it"
            )
        found = re.search(r" (\d+)\.\d+", self.version)
        knows = not self.is_gcc or (found is not None and int(found.group(1)) >= 12)
        return ("-UNDEBUG", f"-DMG_DEBUG={fill}", *(("-ftrivial-auto-var-init=pattern",) if knows else ()))


def portable_flags(compiler: Compiler, real: str) -> tuple[str, ...]:
    """The flags of a library without those that hold for the processor of this machine alone."""
    own = (BASELINE,) if compiler.is_zig else ()
    return (*(flag for flag in compiler.flags(real) if flag not in NATIVE), *own)


def find_compiler() -> Compiler:
    """The compiler named by CC, else cc, gcc, clang, else zig from PyPI; raises CompilerMissing."""
    command = _command()
    if shutil.which(command[0]) is None:
        raise CompilerMissing(
            "CC", f"no program {command[0]!r}", "", "correct CC, or unset it to use cc, gcc or clang"
        )
    return Compiler(command, compiler_version(command))


def compiler_words() -> tuple[str, ...]:
    """The command of `find_compiler`, with the full path of each program in it; empty without a compiler.

    Nothing is run.
    """
    try:
        command = _command()
    except CompilerMissing:
        return ()
    found = ((word, shutil.which(word)) for word in command)
    return tuple(os.path.realpath(path) if path else word for word, path in found)


def _command() -> tuple[str, ...]:
    try:
        named = tuple(shlex.split(os.environ.get("CC", "")))
    except ValueError as error:
        found = f"{os.environ['CC']!r} is no command: {error}"
        raise CompilerMissing("CC", found, "", "correct CC, or unset it to use cc, gcc or clang") from None
    if named and os.sep in named[0] and shutil.which(named[0]):  # relative to here, and run in other folders
        return (os.path.abspath(named[0]), *named[1:])
    return named or _first_installed()


def _first_installed() -> tuple[str, ...]:
    for name in CANDIDATES:
        if shutil.which(name):
            return (name,)
    if importlib.util.find_spec("ziglang"):
        return (sys.executable, "-m", "ziglang", "cc")
    found = f"no C compiler was found (CC, {', '.join(CANDIDATES)})"
    raise CompilerMissing("", found, "", install("compiler"))


@cache
def compiler_version(command: tuple[str, ...]) -> str:
    """What a compiler prints for --version; raises CompilerMissing where it does not run."""
    asked = f"`{shlex.join(command)} --version`"
    try:
        answer = subprocess.run(
            [*command, "--version"], capture_output=True, text=True, errors="replace", check=True
        )
    except (OSError, subprocess.CalledProcessError) as error:
        raise CompilerMissing("CC", f"{asked} fails: {error}", "", "name a C compiler that works") from None
    if not answer.stdout.strip():
        raise CompilerMissing("CC", f"{asked} tells nothing", "", "name a C compiler that works")
    return answer.stdout.strip()


@cache
def takes(command: tuple[str, ...], flag: str) -> bool:
    """Whether a compiler compiles an empty text with a flag, without a word about it."""
    from modelgen.file_writing import scratch_folder  # as in run_program

    with scratch_folder() as folder:
        answer = run_program([*command, flag, "-c", "-x", "c", os.devnull, "-o", "empty.o"], folder)
    return answer.returncode == 0 and not answer.stderr


def cpu_target() -> str:
    """The processor features for which -march=native generates code on this machine."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    facts = {
        line.partition(":")[0].strip(): line.partition(":")[2].strip() for line in reversed(lines) if line
    }
    known = [facts[key] for key in ("vendor_id", "cpu family", "model", "flags", "Features") if key in facts]
    return "; ".join([platform.machine(), *(known or [platform.processor()])])


def compile_object(compiler: Compiler, flags: tuple[str, ...], source: Path, target: Path, log: Path) -> None:
    """Compile `source` to the object `target`; a failure raises LibraryError, with the output in `log`."""
    run_compiler([*compiler.command, *flags, "-c", "-o", str(target), source.name], source.parent, log)


def compile_library(
    compiler: Compiler, flags: tuple[str, ...], source: Path, runtime: Path, target: Path, log: Path
) -> None:
    """Compile `source` and link it with the object `runtime` to the shared library `target`.

    A failure raises LibraryError and leaves the compiler's output in `log`.
    """
    named = ["-o", str(target), source.name, str(runtime)]
    run_compiler([*compiler.command, *flags, *SHARED, *named, *LIBRARIES], source.parent, log)


def run_program(command: Sequence[str], folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder, with temporary files in one of their own.

    When the caller is interrupted, neither the program nor those that it has started go on.
    """
    from modelgen.file_writing import scratch_folder  # what was built before is run without it

    with (
        scratch_folder() as temporary,
        subprocess.Popen(
            command,
            cwd=folder,
            env={**os.environ, "TMPDIR": str(temporary)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            process_group=0,
        ) as program,
    ):
        try:
            out, err = program.communicate()
        except BaseException:
            with suppress(ProcessLookupError, subprocess.TimeoutExpired):
                os.killpg(program.pid, signal.SIGKILL)
                program.communicate(timeout=KILLED_S)  # until the last of them has closed its output
            raise
    return subprocess.CompletedProcess(command, program.returncode, out, err)


def run_compiler(command: list[str], folder: Path, log: Path) -> None:
    """Run a compiler's command in a folder; a failure, or no file, raises LibraryError, with the output in
    `log`."""
    answer = run_program(command, folder)
    made = folder / command[command.index("-o") + 1]
    if answer.returncode == 0 and made.is_file() and made.stat().st_size:
        return
    put(log, f"$ {shlex.join(command)}\n{answer.stdout}{answer.stderr}")
    found = f"the compiler ended with {answer.returncode}: {first_error(answer) or f'no file {made.name!r}'}"
    wrong = "" if answer.returncode else "CC names no C compiler: correct or unset it; "
    raise LibraryError(shlex.join(command), found, "", f"{wrong}its output is in {log}")


def first_error(answer: subprocess.CompletedProcess[str]) -> str:
    """The first line in which a program tells of an error; empty where there is none."""
    return next((line for line in answer.stderr.splitlines() if "error" in line), "")
