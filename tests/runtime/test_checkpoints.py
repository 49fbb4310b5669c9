"""A saved state goes on bit for bit: in the same process, in another one, and in C."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
import sys
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from modelgen import Accuracy, read
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.trajectory import Event
from tests.c_compiler import needs_c
from tests.running import NAMES, SCENES, library_of, scene_of
from tests.runtime.c_programs import program_of

HERE = Path(__file__).parent
PER_SCENE = 6  # with 40 scenes, more than 200 instants
LONGEST = 1.0  # s: how much of a run is sampled
AHEAD = 12  # accepted steps that are compared after an instant
STEPPING = Accuracy(method="time-stepping", step=2e-3)


def begun(library: Library, accuracy: Accuracy) -> Session:
    session = Session(library, accuracy)
    assert session.begin() == 0
    return session


def advanced(session: Session, until: float, steps: int) -> tuple[int, list[Event]]:
    """At most so many steps, or up to `until`: the code and the events."""
    record, events = session.tables.Record(), list[Event]()
    code = FULL
    while code == FULL:
        code = session.advance(until, steps, record)
        events += session.drain_events()
    return code, events


def to_instant(session: Session, chance: Random, span: float) -> None:
    """To a random time, to a random step, or to the step that ends at the first event after a random time."""
    way = chance.choice(("time", "step", "event"))
    code, _ = advanced(session, chance.uniform(0.0, span), 10**6)
    if way == "step":
        advanced(session, span, chance.randint(1, 30))
    for _ in range(1000 if way == "event" and code == 0 else 0):
        code, events = advanced(session, span, 1)
        if events or code != CONTINUE:
            break


def continued(session: Session, until: float) -> tuple[list[bytes], list[Event]]:
    """The states of the steps that follow, one by one, and then of a call up to a time."""
    states, told = [], list[Event]()
    for steps in (*[1] * AHEAD, 10**3):
        code, events = advanced(session, until, steps)
        states.append(session.save() + bytes([code]))
        told += events
    return states, told


def instant_of(name: str, number: int) -> tuple[Session, float]:
    """A session at a random instant of a shipped scene, every third of them in time-stepping, and a time to
    which to go on."""
    library = scene_of(name)
    chance = Random(f"{name} {number}")
    span = min(float(library.manifest.instance["run"]["until"]), LONGEST)
    session = begun(library, STEPPING if number % 3 == 2 else Accuracy.balanced())
    to_instant(session, chance, span)
    return session, float(session.run.t) + 0.05 * span


def assert_goes_on_alike(session: Session, until: float) -> None:
    other = Session(session.library, session.accuracy)
    other.load(session.save())
    assert other.save() == session.save()
    assert continued(other, until) == continued(session, until)


CASES = [(name, number) for number in range(PER_SCENE) for name in NAMES]


@pytest.mark.cases(8)
@pytest.mark.parametrize(("name", "number"), CASES)
def test_a_saved_state_goes_on_bit_for_bit(name: str, number: int) -> None:
    assert_goes_on_alike(*instant_of(name, number))


def kinds_of(session: Session) -> set[str]:
    """What is going on at an instant."""
    run, closed = session.run, session.closed[: session.n_contact].any()
    holds = {
        "flight": session.n_contact > 0 and not closed,
        "contact": closed,
        "sticking": (session.run_arrays["friction_mode"] == 1).any(),
        "slipping": (session.run_arrays["friction_mode"] == 4).any(),
        "flat": (session.feature_pair[session.n_shown : session.n_contact] >= 0).any(),
        "time-stepping": session.settings.method == 2 or run.fallback_left > 0,
        "event": run.t == run.t_event and run.t > 0,
        "joints": bool(session.joints),
        "searched": session.system.n_cell_tree > 0,
    }
    return {name for name, held in holds.items() if held}


@pytest.mark.slow
def test_the_instants_are_of_every_kind() -> None:
    found = [kinds_of(instant_of(*case)[0]) for case in CASES]
    counts = {kind: sum(kind in kinds for kinds in found) for kind in sorted(set().union(*found))}
    assert len(counts) == 9
    assert min(counts.values()) >= 4, counts


@pytest.mark.parametrize("name", ["cube_toss", "gears", "four_bar", "sliding_puck", "brake_shoe"])
def test_the_scratch_memory_holds_nothing_of_a_run(name: str) -> None:
    """A run is the same when what its scratch memory holds is replaced between calls, by noise and by what
    another run of the scene left."""
    library = scene_of(name)
    noise = np.random.default_rng(3)
    alone, disturbed, other = (begun(library, Accuracy.balanced()) for _ in range(3))
    for number in range(40):
        if number % 2:
            disturbed.work[:] = noise.standard_normal(len(disturbed.work))
            disturbed.iwork[:] = noise.integers(-(2**31), 2**31, len(disturbed.iwork))
        else:
            advanced(other, 0.5, 3)
            disturbed.work[:], disturbed.iwork[:] = other.work, other.iwork
        assert advanced(disturbed, 0.5, 2) == advanced(alone, 0.5, 2)
        assert disturbed.save() == alone.save()


@pytest.mark.parametrize("real", ["float", "long double"])
def test_every_real_type_is_saved(real: str) -> None:
    session = begun(scene_of("bouncing_ellipsoid", real=real), Accuracy.fast())
    advanced(session, 0.2, 10**6)
    other = Session(session.library, session.accuracy)
    other.load(session.save())
    assert advanced(other, 0.4, 10**6) == advanced(session, 0.4, 10**6)
    for array, same in zip(session.run_arrays.values(), other.run_arrays.values(), strict=True):
        np.testing.assert_array_equal(array, same)


CHILD = """
import sys
from pathlib import Path
from modelgen import Accuracy
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
session = Session(Library.load(sys.argv[1]), Accuracy.balanced())
session.load(Path(sys.argv[2]).read_bytes())
record = session.tables.Record()
while session.advance(float(sys.argv[3]), 10**6, record) in (1, 2):
    session.events.count = 0
Path(sys.argv[2]).write_bytes(session.save())
"""


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", NAMES)
def test_a_saved_state_goes_on_in_another_process(name: str, tmp_path: Path) -> None:
    session, until = instant_of(name, 0)
    folder = session.library.path.parent
    manifest = session.library.manifest  # libraries of tests share a folder: this one's numbers are its own
    for file in folder.iterdir():
        if file.is_file():
            shutil.copy(file, tmp_path)
    (tmp_path / "instance.json").write_text(manifest.instance_json())
    (tmp_path / "manifest.json").write_text(manifest.structure_json())
    state = tmp_path / "state"
    state.write_bytes(session.save())
    subprocess.run([sys.executable, "-c", CHILD, tmp_path, state, repr(until)], check=True)
    advanced(session, until, 10**6)
    assert state.read_bytes() == session.save()


C_MAIN = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static unsigned char state[{size}];
static void keep(const char *name) {{
  FILE *file = fopen(name, "wb");
  mg_save(&the_system, &the_settings, &the_run, state);
  fwrite(state, 1, sizeof state, file);
  fclose(file);
}}
static int go(double until) {{
  int code;
  mg_record none;
  memset(&none, 0, sizeof none);
  do {{
    the_events.count = 0;
    code = mg_advance(&the_system, &the_settings, &the_run, until, 100000, &none, &the_events, work, iwork);
  }} while (code == MG_CONTINUE || code == MG_LIST_FULL);
  return code;
}}
int main(int argc, char **argv) {{
  the_system.kernels = mg_kernel_table();
  if (mg_save_size(&the_system) != (long)sizeof state) return 90;
  if (strcmp(argv[1], "begin") == 0) {{
    if (mg_begin(&the_system, &the_settings, &the_run, &the_events, work, iwork)) return 91;
    if (go(atof(argv[2]))) return 91;
    keep(argv[3]);
  }} else {{
    FILE *file = fopen(argv[3], "rb");
    const long length = (long)fread(state, 1, sizeof state, file);
    fclose(file);
    const int code = mg_load(&the_system, &the_settings, &the_run, state, length);
    if (code) return code;
  }}
  if (go(atof(argv[4]))) return 92;
  keep(argv[5]);
  return argc == 6 ? 0 : 93;
}}
"""


@needs_c
@pytest.mark.cases(2)
@pytest.mark.parametrize(
    "name",
    ["cube_toss", "gripper", "gears", "sliding_puck", "four_bar", "bouncing_ellipsoid", "wheel_on_rail"],
)
def test_a_saved_state_goes_on_in_c(name: str, tmp_path: Path) -> None:
    """One process saves and goes on, another loads and goes on: the same bytes. A state that Python saved is
    loaded, too, and is where the program is."""
    run = program_of(name, tmp_path, C_MAIN, Accuracy.balanced())

    def program(*arguments: object) -> int:
        return subprocess.run([run, *map(str, arguments)], cwd=tmp_path, check=False).returncode

    assert program("begin", 0.31, "state", 0.43, "end") == 0
    assert program("load", 0, "state", 0.43, "again") == 0
    assert (tmp_path / "again").read_bytes() == (tmp_path / "end").read_bytes()
    session = begun(scene_of(name), Accuracy.balanced())
    advanced(session, 0.31, 10**6)
    (tmp_path / "python").write_bytes(session.save())
    assert program("load", 0, "python", 0.43, "from_python") == 0
    session.load((tmp_path / "from_python").read_bytes())
    assert session.run.t == 0.43
    length = (tmp_path / "state").stat().st_size
    (tmp_path / "cut").write_bytes((tmp_path / "state").read_bytes()[: length // 2])
    assert program("load", 0, "cut", 0.43, "never") == 8


def refused(session: Session, state: Any) -> str:
    before = session.save()
    with pytest.raises(SimulationError) as caught:
        session.load(state)
    assert session.save() == before
    return str(caught.value)


def test_what_does_not_fit_is_refused_and_named() -> None:
    library = scene_of("bouncing_ellipsoid")
    session = begun(library, Accuracy.balanced())
    state = session.save()
    middle = len(state) // 2
    changed = state[:middle] + bytes([state[middle] ^ 1]) + state[middle + 1 :]
    assert "a str" in refused(session, "text")
    assert "no saved state" in refused(session, b"")
    assert "no saved state" in refused(session, b"x" * len(state))
    assert "missing or changed" in refused(session, state[:-1])
    assert "missing or changed" in refused(session, state + b"0")
    assert "missing or changed" in refused(session, changed)
    tight = begun(library, Accuracy.tight()).save()
    assert "other settings" in refused(session, tight)
    assert "give the accuracy" in refused(session, tight)
    assert "another library" in refused(session, begun(scene_of("cube_toss"), Accuracy.balanced()).save())
    assert "another real type" in refused(
        session, begun(scene_of("bouncing_ellipsoid", real="float"), Accuracy.balanced()).save()
    )
    session.load(memoryview(state))


@pytest.mark.parametrize(
    ("key", "value"),
    [("restitution", 0.7), ("friction", 0.3), ("density", 1001.0), ("gravity", [0.0, 0.0, -9.8])],
)
def test_a_state_is_not_loaded_into_a_scene_with_another_number(
    key: str, value: object, tmp_path: Path
) -> None:
    text = (SCENES / "bouncing_ellipsoid.toml").read_text()
    changed = re.sub(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
    changed = f"{key} = {value}\n{text}" if changed == text else changed
    sessions = []
    for number, each in enumerate((text, changed)):
        file = tmp_path / f"{number}.toml"
        file.write_text(each)
        sessions.append(begun(library_of(read(file)), Accuracy.balanced()))
    one, other = sessions
    assert one.library.record.hash == other.library.record.hash
    assert "other tables" in refused(other, one.save())


def test_a_version_is_refused_before_anything_else_is_read() -> None:
    session = begun(scene_of("bouncing_ellipsoid"), Accuracy.balanced())
    state = bytearray(session.save())
    width = ctypes.sizeof(ctypes.c_ulonglong)
    state[width : 2 * width] = (10**6).to_bytes(width, sys.byteorder)
    assert "another version" in refused(session, bytes(state))
