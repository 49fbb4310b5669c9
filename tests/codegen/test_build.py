"""A library is compiled once for each content; everything else is refused with a message."""

from __future__ import annotations

import os
import random
import shlex
import shutil
import signal
import stat
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import FrameType

import pytest

from modelgen import build, derive, emit, require
from modelgen.codegen import compiler
from modelgen.codegen.amalgamation import SOURCE
from modelgen.codegen.built_files import _key, cache_folder, made_once, put, seal
from modelgen.codegen.emit import Package
from modelgen.codegen.library import Library
from modelgen.codegen.manifest import INSTANCE, STRUCTURE
from modelgen.errors import CompilerMissing, LibraryError
from modelgen.file_writing import scratch_folder
from tests.c_compiler import CC, needs_c
from tests.model.scenes import TABLE, contact, egg, scene

pytestmark = needs_c


def package(axes: str = "[0.12, 0.09, 0.07]", more: str = "density = 1000.0", form: str = "auto") -> Package:
    return emit(
        derive(require(scene(TABLE, egg("egg", axes, more), contact("egg", "table", f'form = "{form}"'))))
    )


@pytest.fixture(scope="session")
def quick_compiler(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A compiler that does not optimise and writes its arguments as one line to the file that CALLS names."""
    script = tmp_path_factory.mktemp("compiler") / "cc"
    script.write_text(
        f'#!/bin/sh\ncase "$*" in *--version*) exec {shlex.join(CC)} --version;; esac\n'
        f'echo "$*" >> "$CALLS"\nexec {shlex.join(CC)} "$@" -O0\n'
    )
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    return script


@pytest.fixture
def calls(quick_compiler: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The list of what the quick compiler has compiled; cores are kept for the session alone."""
    log = tmp_path / "calls"
    log.touch()
    monkeypatch.setenv("CC", str(quick_compiler))
    monkeypatch.setenv("CALLS", str(log))
    monkeypatch.setenv("MODELGEN_CACHE", str(quick_compiler.parent))
    return log


def count(calls: Path, source: str = "model.c") -> int:
    """How often a source was compiled."""
    return sum(source in line.split() for line in calls.read_text().splitlines())


def test_the_second_build_compiles_nothing(calls: Path, tmp_path: Path) -> None:
    first = build(package(), folder=tmp_path / "out")
    second = build(package(), folder=tmp_path / "out")
    assert count(calls) == 1
    assert first.path == second.path
    assert (first.manifest, first.record) == (second.manifest, second.record)


def test_changed_numbers_compile_nothing(calls: Path, tmp_path: Path) -> None:
    first = build(package(), folder=tmp_path / "out")
    moved = "mass = 2.0\ninertia = [0.1, 0.12, 0.14]\nposition = [0, 0, 1]\nvelocity = [1, 0, 0]"
    second = build(package("[0.3, 0.2, 0.1]", moved), folder=tmp_path / "out")
    assert count(calls) == 1
    assert first.path == second.path
    assert first.manifest.instance["initial_q"] != second.manifest.instance["initial_q"]


def test_changed_structure_and_real_type_compile_beside(calls: Path, tmp_path: Path) -> None:
    libraries = [
        build(package(), folder=tmp_path / "out"),
        build(package(form="implicit"), folder=tmp_path / "out"),
    ]
    libraries += [build(package(), real=real, folder=tmp_path / "out") for real in ("float", "long double")]
    assert count(calls) == len({library.path for library in libraries}) == 4
    assert [library.dtype.itemsize for library in libraries[:3]] == [8, 8, 4]


def test_the_hash_stands_in_name_record_and_library(calls: Path, tmp_path: Path) -> None:
    library = build(package(), folder=tmp_path / "out")
    assert library.path.name == f"libtest-{library.record.hash[:16]}.so" == library.record.file
    assert library.cdll.mg_hash().decode() == library.record.hash


def test_the_manifest_knows_neither_machine_nor_real_type(calls: Path, tmp_path: Path) -> None:
    folders = [tmp_path / "a", tmp_path / "b"]
    libraries = [
        build(package(), real=r, folder=f) for r, f in zip(("double", "float"), folders, strict=True)
    ]
    texts = {(folder / "manifest.json").read_text() for folder in folders}
    assert texts == {package().manifest.structure_json()}
    for library in libraries:
        for fact in (*library.record.versions.values(), library.record.hash, str(tmp_path)):
            assert f'"{fact}"' not in next(iter(texts))


def test_the_default_folder_is_generated_scene(
    calls: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    library = build(package())
    assert library.path.parent == tmp_path / "generated" / "test"
    sealed = library.path.name, f"{library.path.name}.seal"
    expected = {*package().files, STRUCTURE, INSTANCE, "library.json", *sealed}
    assert {path.name for path in library.path.parent.iterdir()} == expected


@pytest.mark.parametrize("real", ["double", "long double"])
def test_a_folder_gives_its_library_again(real: str, calls: Path, tmp_path: Path) -> None:
    built, other = (build(package(), real=r, folder=tmp_path) for r in (real, "float"))
    found = Library.load(tmp_path, real)
    assert (found.manifest, found.record, found.path) == (built.manifest, built.record, built.path)
    assert Library.load(tmp_path, "float").path == other.path


def test_a_library_of_another_vocabulary_is_not_taken_for_this_one(calls: Path, tmp_path: Path) -> None:
    build(package(), folder=tmp_path)
    build(package(form="implicit"), real="float", folder=tmp_path)
    with pytest.raises(LibraryError, match=r"kinds.*stale: build again"):
        Library.load(tmp_path)


def test_a_folder_without_a_build_says_so(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match=r"manifest\.json: it cannot be read.*build first"):
        Library.load(tmp_path)
    (tmp_path / STRUCTURE).write_text(package().manifest.structure_json())
    with pytest.raises(LibraryError, match=r"instance\.json: it cannot be read.*build first"):
        Library.load(tmp_path)
    (tmp_path / INSTANCE).write_text(package().manifest.instance_json())
    with pytest.raises(LibraryError, match=r"library-float\.json: it cannot be read.*build first"):
        Library.load(tmp_path, "float")


def test_a_compiler_that_fails_leaves_its_words(calls: Path, tmp_path: Path) -> None:
    broken = package()
    broken = replace(broken, files={**broken.files, "kernels.c": "#error this is wrong\n"})
    with pytest.raises(LibraryError) as caught:
        build(broken, folder=tmp_path / "out")
    (log,) = cache_folder().glob("libtest-*.log")
    assert "this is wrong" in log.read_text()
    assert str(log) in str(caught.value)
    assert "model.c" in str(caught.value)
    assert not list((tmp_path / "out").glob("*.so"))


def test_no_compiler_names_the_command_that_brings_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(CompilerMissing, match=r'no C compiler.*pip install "modelgen-contact\[compiler\]"'):
        build(package(), folder=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_without_a_compiler_what_was_built_for_this_processor_is_taken(
    calls: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built = build(package(), folder=tmp_path / "out")

    def missing() -> compiler.Compiler:
        raise CompilerMissing("", "no C compiler was found", "", "")

    monkeypatch.setattr("modelgen.codegen.build.find_compiler", missing)
    assert build(package(), folder=tmp_path / "out").path == built.path
    with pytest.raises(CompilerMissing):
        build(package(form="implicit"), folder=tmp_path / "out")
    monkeypatch.setattr("modelgen.codegen.build.cpu_target", lambda: "another processor")
    with pytest.raises(CompilerMissing):
        build(package(), folder=tmp_path / "out")


def test_a_compiler_may_be_named_from_the_current_folder(
    calls: Path, quick_compiler: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it compiles lies in other folders."""
    monkeypatch.chdir(quick_compiler.parent)
    monkeypatch.setenv("CC", f"./{quick_compiler.name}")
    assert build(package(), folder=tmp_path / "out").path.is_file()
    assert count(calls) == 1


@pytest.mark.parametrize("command", ["no-such-compiler", "false", "'", '"cc'])
def test_a_wrong_cc_is_named(command: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CC", command)
    with pytest.raises(CompilerMissing, match=f"^CC: .*{command}"):
        build(package(), folder=tmp_path / "out")


@pytest.mark.parametrize("command", ["echo", "true"])
def test_a_compiler_that_makes_nothing_is_told(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", command)
    monkeypatch.setenv("MODELGEN_CACHE", str(tmp_path / "cache"))
    with pytest.raises(LibraryError, match=r"the compiler ended with 0: no file 'runtime-.*its output is in"):
        build(package(), folder=tmp_path / "out", tell=lambda line: None)


def test_zig_is_the_last_resort(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(compiler, "CANDIDATES", ())
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(compiler, "compiler_version", lambda command: "clang version 22")
    monkeypatch.setattr(compiler, "takes", lambda command, flag: True)
    found = compiler.find_compiler()
    assert found.command[1:] == ("-m", "ziglang", "cc")
    assert "-march=native" not in found.flags("double")


def test_zig_is_known_behind_a_script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its command says nothing of it; what it is told must still be what Zig takes."""
    pytest.importorskip("ziglang")
    script = tmp_path / "mycc"
    script.write_text(f'#!/bin/sh\nexec {sys.executable} -m ziglang cc "$@"\n')
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    found = compiler.find_compiler()
    assert found.is_zig
    assert "-mcpu=baseline" in compiler.portable_flags(found, "double")
    for flag in (*found.flags("double"), *compiler.portable_flags(found, "double")):
        assert compiler.takes(found.command, flag), flag


def test_a_compiler_that_warns_of_the_flag_of_zig_is_not_zig(tmp_path: Path) -> None:
    warns = tmp_path / "warns"
    warns.write_text('#!/bin/sh\necho "warning: argument unused: $1" >&2\n')
    warns.chmod(0o755)
    assert not compiler.Compiler((str(warns),), "clang version 14").is_zig


def test_passes_of_gcc_are_named_to_gcc_alone() -> None:
    gcc = compiler.Compiler(("cc",), "cc (Distribution 12.2.0) 12.2.0\nFree Software Foundation, Inc.")
    clang = compiler.Compiler(("cc",), "Apple clang version 15.0.0")
    assert set(gcc.flags("double")) - set(clang.flags("double")) == set(compiler.QUICK_GCC)


def test_an_unknown_real_type_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match=r"'half'.*double, float, long double"):
        build(package(), real="half", folder=tmp_path)


@pytest.mark.parametrize(
    ("change", "message"),
    [({"hash": "0" * 64}, "hash"), ({"real": "float"}, "size of the real type")],
)
def test_a_stale_record_is_refused(change: dict[str, str], message: str, calls: Path, tmp_path: Path) -> None:
    library = build(package(), folder=tmp_path)
    with pytest.raises(LibraryError, match=f"{message}.*stale"):
        Library(library.manifest, replace(library.record, **change), tmp_path)  # type: ignore[arg-type]


def test_a_manifest_of_another_abi_is_refused(calls: Path, tmp_path: Path) -> None:
    library = build(package(), folder=tmp_path)
    with pytest.raises(LibraryError, match=r"ABI.*stale"):
        Library(replace(library.manifest, abi=99), library.record, tmp_path)


def test_a_renamed_foreign_or_missing_library_is_refused(calls: Path, tmp_path: Path) -> None:
    library = build(package(), folder=tmp_path)
    renamed = library.path.with_name("libtest-0123456789abcdef.so")
    shutil.copy(library.path, renamed)
    (tmp_path / "text.so").write_text("not a library")
    (tmp_path / "empty.c").write_text("int nothing;\n")
    subprocess.run([*CC, "-shared", "-fPIC", "-o", "foreign.so", "empty.c"], cwd=tmp_path, check=True)
    (tmp_path / "planted.so").write_bytes((tmp_path / "foreign.so").read_bytes())
    for name in (renamed.name, "text.so", "foreign.so"):
        seal(tmp_path / name)
    for file, message in (
        (renamed.name, "hash in the file name"),
        ("text.so", "cannot be loaded"),
        ("none.so", "no such file"),
        ("foreign.so", "not a library of modelgen"),
        ("planted.so", "no build of yours wrote it"),
    ):
        with pytest.raises(LibraryError, match=message):
            Library(library.manifest, replace(library.record, file=file), tmp_path)


def test_the_core_is_compiled_once_for_each_real_type(
    calls: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MODELGEN_CACHE", str(tmp_path / "cache"))
    told: list[str] = []
    for real in ("double", "float"):
        build(package(), real=real, folder=tmp_path / real, tell=told.append)
    build(package(form="implicit"), folder=tmp_path / "other", tell=told.append)
    assert count(calls, SOURCE) == len(told) == 2
    assert count(calls) == 3
    assert all(str(tmp_path / "cache") in line for line in told)


def test_processes_that_build_at_once_compile_one_core(
    calls: Path, quick_compiler: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One of them is killed while it compiles; what it leaves is not taken for an object."""
    monkeypatch.setenv("MODELGEN_CACHE", str(tmp_path / "cache"))
    ask = (
        "from modelgen.codegen.compiler import find_compiler\n"
        "from modelgen.codegen.core_cache import runtime_object\n"
        "compiler = find_compiler()\n"
        "print(runtime_object(compiler, compiler.flags('double')))\n"
    )
    command = [sys.executable, "-c", ask]
    killed = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while count(calls, SOURCE) == 0:
        time.sleep(0.02)
    killed.kill()
    killed.wait()
    both = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    paths = {process.communicate()[0].strip() for process in both}
    assert [process.returncode for process in both] == [0, 0]
    assert len(paths) == 1
    assert Path(paths.pop()).is_file()
    assert count(calls, SOURCE) == 2


def damages(content: bytes) -> dict[str, bytes]:
    """What is left of a file after a crash, an error of a disk or a careless hand."""
    draw = random.Random(1)
    flipped = bytearray(content)
    for _ in range(20):
        flipped[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
    at = draw.randrange(len(content))
    return {
        "empty": b"",
        "half": content[: len(content) // 2],
        "less by a byte": content[:-1],
        "more by a byte": content + b"\0",
        "zeros at the end": content[:at] + bytes(len(content) - at),
        "random": draw.randbytes(len(content)),
        "flipped": bytes(flipped),
        "text": "dlopen me".encode("utf-16"),
    }


DAMAGES = tuple(damages(b"x" * 99))


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_library_is_built_again(damage: str, calls: Path, tmp_path: Path) -> None:
    """It is refused where nothing may be compiled, and the next build replaces it."""
    path = build(package(), folder=tmp_path).path
    whole = path.read_bytes()
    path.unlink()  # this process has mapped it
    damaged = damages(whole)[damage]
    path.write_bytes(damaged)
    with pytest.raises(LibraryError, match=r"damaged.*build again"):
        Library.load(tmp_path)
    assert build(package(), folder=tmp_path).path.read_bytes() != damaged  # Zig makes other bytes each time
    assert Library.load(tmp_path).path == path


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_file_of_the_cache_is_made_again(
    damage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the file itself, its seal, and the key, with which all seals go."""
    monkeypatch.setenv("MODELGEN_CACHE", str(tmp_path))
    made = []

    def make(scratch: Path) -> None:
        made.append((scratch / "in").read_text())
        (scratch / "out.o").write_bytes(bytes(range(256)))

    path = made_once(tmp_path / "out.o", {"in": "text"}, make)
    for name in ("out.o", "out.o.seal", "key"):
        _key.cache_clear()
        (tmp_path / name).write_bytes(damages((tmp_path / name).read_bytes())[damage])
        assert made_once(path, {"in": "text"}, make).read_bytes() == bytes(range(256))
        made_once(path, {"in": "text"}, make)
    assert made == ["text"] * 4
    assert not list(tmp_path.glob(".build-*"))


def test_damaged_texts_of_a_folder_are_written_again(calls: Path, tmp_path: Path) -> None:
    library = build(package(), folder=tmp_path)
    names = (*package().files, STRUCTURE, INSTANCE, "library.json")
    texts = {tmp_path / name: (tmp_path / name).read_bytes() for name in names}
    for path, whole in texts.items():
        for damaged in damages(whole).values():
            path.write_bytes(damaged)
            with suppress(LibraryError):  # C text is not read
                Library.load(tmp_path)
            build(package(), folder=tmp_path)
            assert path.read_bytes() == whole
    assert library.path.is_file()


def test_a_link_in_the_way_of_a_built_file_is_not_followed(calls: Path, tmp_path: Path) -> None:
    library = build(package(), folder=tmp_path / "out")
    kept = tmp_path / "kept"
    for path in list((tmp_path / "out").iterdir()):
        kept.write_text("mine")
        path.unlink()
        path.symlink_to(kept)
        build(package(), folder=tmp_path / "out")
        assert kept.read_text() == "mine", path
    assert build(package(), folder=tmp_path / "out").path == library.path


def test_a_folder_that_a_killed_build_left_is_removed(calls: Path, tmp_path: Path) -> None:
    for name in (".build-libtest-0123456789abcdef.so", ".build-x1y2"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "model.c").touch()
    build(package(), folder=tmp_path)
    assert not list(tmp_path.glob(".build-*"))


def test_a_cache_that_cannot_be_made_is_named(
    calls: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("MODELGEN_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.raises(LibraryError, match=r"cache folder cannot be made.*MODELGEN_CACHE"):
        build(package(), folder=tmp_path / "out")


def test_a_scene_of_very_many_pairs_of_features_says_what_it_costs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    build(package(), folder=tmp_path / "few", tell=told.append)
    assert not any("pairs of features" in line for line in told)
    monkeypatch.setattr("modelgen.codegen.build.MANY", 0)
    build(package(), folder=tmp_path / "many", tell=told.append)
    assert "1 pairs of features: about 0 s of CPU time" in told[-1]
    assert "--method time-stepping" in told[-1]


def test_a_library_for_its_own_processor_fuses_no_products_and_sums() -> None:
    found = compiler.find_compiler()
    asked = [*found.command, *found.flags("double"), "-dM", "-E", "-x", "c", os.devnull]
    defined = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    assert "__FMA" not in defined or not compiler.IS_X86 or found.is_zig


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_a_folder_is_removed_leaves_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals
) -> None:
    """Each first removal is broken into before it has begun, as by Ctrl-C while it runs."""
    remove = shutil.rmtree
    met: set[Path] = set()

    def interrupted(folder: Path, **options: bool) -> None:
        if folder.exists() and folder not in met:
            met.add(folder)
            os.kill(os.getpid(), number)
            time.sleep(0)  # handlers run between two instructions of Python
        remove(folder, **options)

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(shutil, "rmtree", interrupted)
    before = signal.signal(number, interrupt)
    try:
        with pytest.raises(KeyboardInterrupt):
            made_once(tmp_path / "out.o", {"in": "text"}, lambda folder: put(folder / "out.o", b"object"))
        with pytest.raises(KeyboardInterrupt), scratch_folder() as folder:
            put(folder / "file", "text")
    finally:
        signal.signal(number, before)
    assert not folder.exists()
    assert not list(tmp_path.iterdir())
