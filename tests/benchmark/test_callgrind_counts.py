"""A run as a C program, and its instructions."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from modelgen import build, derive, emit, read, require
from modelgen.benchmark.callgrind_counts import instructions, why_not_counted
from modelgen.codegen.amalgamation import SOURCE, runtime_text
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.c_initialisers import driver_text
from modelgen.runtime.simulate import simulate
from modelgen.scene.scene_types import Scene
from tests.running import SCENES, library_of

UNTIL = 0.05
COUNTED = pytest.mark.skipif(bool(why_not_counted()), reason="valgrind is not installed")
END = """
#include <stdio.h>
int run(void);
int main(void) {
  int code = run();
  for (int i = 0; i < 7; i++) printf("%.17g\\n", (double)the_run.x[i]);
  return code;
}
"""


@pytest.mark.slow
def test_the_program_ends_where_the_run_does(tmp_path: Path) -> None:
    library = library_of(named("ended"))
    text = driver_text(library, Accuracy.balanced(), UNTIL)
    (tmp_path / SOURCE).write_text(runtime_text())
    (tmp_path / "run.c").write_text(text.replace("int main(void)", "int run(void)") + END)
    model, folder = library.path.parent / "model.c", library.path.parent
    command = [
        "cc",
        "-std=c99",
        "-O0",
        '-DMG_HASH="x"',
        f"-I{folder}",
        "run.c",
        str(model),
        SOURCE,
        "-o",
        "run",
        "-lm",
    ]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    found = [float(line) for line in subprocess.check_output([tmp_path / "run"], text=True).split()]
    path = simulate(library, until=UNTIL, accuracy=Accuracy.balanced(), samples=1)
    assert found[:3] == pytest.approx(path.p[-1, 1], abs=1e-12)
    assert found[3:] == pytest.approx(path.quaternion[-1, 1], abs=1e-12)


def named(name: str, form: str = "auto") -> Scene:
    scene = read(SCENES / "ellipsoid_on_plane.toml")
    return replace(scene, name=name, contacts=tuple(replace(pair, form=form) for pair in scene.contacts))


@pytest.mark.slow
@COUNTED
def test_instructions_grow_with_the_steps() -> None:
    library = library_of(named("counted"))
    coarse, fine = (
        instructions(library, Accuracy.balanced().fixed_step(h), UNTIL, "O2") for h in (2e-3, 1e-3)
    )
    assert coarse is not None
    assert fine is not None
    assert 1.8 < fine / coarse < 2.2


@pytest.mark.slow
@COUNTED
def test_a_folder_that_holds_another_form_is_not_counted(tmp_path: Path) -> None:
    library, _ = (
        build(emit(derive(require(named("built_over", form)))), folder=tmp_path)
        for form in ("auto", "implicit")
    )
    assert instructions(library, Accuracy.balanced(), UNTIL, "O2") is None
