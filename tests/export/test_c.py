"""`--to c`: the folder compiles without a warning anywhere, and its self-test passes wherever it can run."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests.c_compiler import CC, needs_c
from tests.export.folders import ZIG, compiled, exported, needs_gcc, needs_zig, runner, said

TARGETS = ("aarch64-linux-musl", "arm-linux-musleabihf", "x86_64-windows-gnu", "wasm32-wasi")
SANITIZED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
DEEP = ("helix_on_cylinder", "slider_crank", "gears", "coin_in_bowl", "glass_on_table", "four_bar")
STACK = 64 * 1024  # bytes, enough for every shipped scene
SCENES_OF_KINDS = (  # patches, inputs, joints, limits
    *("box_dropped", "balancing_wheel", "four_bar", "rolling_disc", "double_pendulum"),
)


@needs_c
def test_the_self_test_compiles_without_a_warning_and_passes(tmp_path: Path) -> None:
    """On a stack of 64 KiB."""
    folder = exported("sphere_slide_to_roll", "c", tmp_path)
    program = compiled(folder, CC, "selftest", "-O0")
    _, told = said(program, by=("sh", "-c", f'ulimit -s {STACK // 1024}; exec "$0"'))
    assert re.search(r"11 of 11 vectors, .*saved state goes on alike; passed", told)


@needs_gcc
@pytest.mark.slow
@pytest.mark.parametrize("level", ["-O0", "-O2"])
@pytest.mark.parametrize("name", DEEP)
def test_a_run_writes_to_no_more_of_its_stack_than_the_readme_tells(
    name: str, level: str, tmp_path: Path
) -> None:
    """And a thread of 64 KiB is enough for it."""
    folder = exported(name, "c", tmp_path, figures=True)
    found = re.search(r"\| stack \| (at least )?(\d+) bytes", (folder / "README.md").read_text())
    assert found is not None
    source = Path(__file__).with_name("stack_probe.c")
    words = [level, "-std=gnu99", "-ffp-contract=off", "-I.", "scene.c", "modelgen_runtime.c", str(source)]
    subprocess.run(["gcc", *words, "-lm", "-lpthread", "-o", "probe"], cwd=folder, check=True)
    thread, run, code = map(int, said(folder / "probe", str(STACK))[0].split())
    assert code == 0
    assert thread + run < STACK
    assert level != "-O2" or run < int(found[2])


@needs_gcc
@pytest.mark.slow
@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("name", SCENES_OF_KINDS)
def test_the_self_test_passes_under_sanitizers(name: str, real: str, tmp_path: Path) -> None:
    folder = exported(name, "c", tmp_path, real=real)
    _, told = said(compiled(folder, ["gcc"], "selftest", "-O0", *SANITIZED, real=real))
    assert "equal to the last bit" in told


@needs_c
@pytest.mark.slow
def test_a_self_test_fails_where_a_number_is_another(tmp_path: Path) -> None:
    folder = exported("sphere_slide_to_roll", "c", tmp_path)
    text = (folder / "scene.c").read_text()
    assert "scene->input" in text
    (folder / "scene.c").write_text(text.replace("-0x1.39eb851eb851fp+3", "-0x1.39eb951eb851fp+3"))
    with pytest.raises(AssertionError, match="FAILED"):
        said(compiled(folder, CC, "selftest", "-O0"))


@needs_zig
@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_other_targets_compile_and_pass(target: str, tmp_path: Path) -> None:
    folder = exported("sphere_slide_to_roll", "c", tmp_path)
    program = compiled(
        folder, ZIG, "selftest.wasm" if "wasm" in target else "selftest", "-O1", "-target", target
    )
    by = runner(target, folder)
    if by is None:
        pytest.skip(f"compiled, but nothing runs programs of {target} here")
    assert "passed" in said(program, by=by)[1]


def test_the_readme_says_why_there_are_no_figures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = (exported("ball_in_bowl", "c", tmp_path / "a") / "README.md").read_text()
    assert "not measured: the export was made with `--no-figures`." in told
    assert "gcc" not in told
    monkeypatch.setattr("modelgen.export.c_folder.footprint_of", lambda *_: None)  # as without gcc
    told = (exported("ball_in_bowl", "c", tmp_path / "b", figures=True) / "README.md").read_text()
    assert "not measured: gcc is needed for that." in told


@needs_gcc
@pytest.mark.slow
def test_the_readme_tells_what_the_scene_needs(tmp_path: Path) -> None:
    text = (exported("ball_in_bowl", "c", tmp_path, figures=True) / "README.md").read_text()
    for row in ("flash", "RAM of one run", "stack"):
        assert re.search(rf"\| {row} \| .*[1-9]\d* bytes", text), text
    assert re.search(r"\| right-hand side .* \d+ instructions", text) or "not counted" in text
