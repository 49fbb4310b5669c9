"""The cost of a right-hand side beside a prototype: `python -m tests.benchmarks.step_cost`.

The prototype (`prototype.c`) holds the generated kernels of a scene with one free body on one fixed plane,
and around them nothing but its mass, one or three equations solved in closed form, and RK4. Both take the
same steps in one run; the instructions of both are counted where valgrind is installed.

Of two linked rings and two linked tori the whole run is timed, per right-hand side: with steps of DOP853, its
searches for closest points, events and projection.

`python -m tests.benchmarks.step_cost core|prototype FOLDER N` takes N steps, for callgrind.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time

import numpy as np

import modelgen
from modelgen.codegen.amalgamation import elementary_text
from modelgen.codegen.compiler import find_compiler
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array, address
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.counting import COUNTED_CPU, callgrind, countable

SCENES_OF_ONE_BODY = ("ellipsoid_on_plane", "rolling_disc", "rolling_ellipsoid")
SCENES = Path(__file__).parents[2] / "scenes"
LINKED_UNTIL, LINKED_REPEATS = 5.0, 60  # s of a run, and how many runs
STEP, STEPS, REPEATS = 1e-5, 1000, 600  # short runs in turn: the least of many is undisturbed
STAGES = 4
COUNTED = 100_000  # steps under callgrind


class Kernels(ctypes.Structure):
    """What the prototype takes: addresses of numbers of the scene (`scene` in prototype.c)."""

    _fields_ = [(name, ctypes.c_void_p) for name in ("place", "gravity", "body", "contact", "mass_inverse")]


def built(scene: Scene) -> Library:
    return modelgen.build(modelgen.emit(modelgen.derive(modelgen.require(scene))))


def library_of(name: str) -> Library:
    return built(modelgen.read(SCENES / f"{name}.toml"))


def start(library: Library) -> Session:
    """A session at the start of the scene, in contact, sticking where there is friction."""
    session = Session(library, modelgen.Accuracy.tight().fixed_step(STEP))
    begin(session)
    assert session.active.any()
    assert (session.friction_mode[:-1] == 1).all()
    return session


def feature_pair_of(session: Session) -> int:
    """The number of the feature pair that the contact is on."""
    return int(session.feature_pair[int(np.flatnonzero(session.active)[0])])


def compiled_prototype(session: Session, folder: Path, cpu: str) -> Path:
    """The prototype of a scene at a start, compiled with the flags of its library."""
    library, instance = session.library, session.instance
    pair = instance["feature_pairs"][feature_pair_of(session)]
    kinds = library.manifest.kinds
    fixed_o = instance["bodies"][pair["o"]]["motion"] == "fixed"
    moved = instance["bodies"][pair["f" if fixed_o else "o"]]
    defines = {
        "BODY_KIND": moved["kind"],
        "CONTACT_KIND": pair["kind"],
        "ROWS": kinds["contact"][pair["kind"]].get("rows", 1),
        "N_ETA": kinds["contact"][pair["kind"]]["n_eta"],
        "BODY_IS_O": int(not fixed_o),
    }
    compiler, target = find_compiler(), folder / "prototype.so"
    flags = [cpu if flag == "-march=native" else flag for flag in compiler.flags("double")]
    source, elementary = Path(__file__).parent / "prototype.c", folder / "elementary.c"
    elementary.write_text(elementary_text())
    named = [f"-I{library.path.parent}", *(f"-D{name}={value}" for name, value in defines.items())]
    subprocess.run(
        [*compiler.command, *flags, *named, "-shared", str(source), str(elementary), "-o", str(target)],
        check=True,
    )
    return target


class Prototype:
    """The prototype of a scene at the state of a session."""

    def __init__(self, session: Session, path: Path) -> None:
        instance, system = session.instance, session.system
        number = feature_pair_of(session)
        pair = instance["feature_pairs"][number]
        fixed, moved = sorted(
            (pair["o"], pair["f"]), key=lambda b: instance["bodies"][b]["motion"] != "fixed"
        )
        bodies = instance["bodies"]
        offsets = np.ctypeslib.as_array(
            ctypes.cast(system.body_parameters, ctypes.POINTER(ctypes.c_int)), (len(bodies),)
        )
        of_pair = ctypes.cast(system.feature_pair_parameters, ctypes.POINTER(ctypes.c_int))[number]
        mass = np.array(bodies[moved]["mass_inverse"])
        self.mass_inverse = mass[[0, 1, 5, 9]].copy()
        self.gravity = np.array(instance["gravity"])
        self.kernels = Kernels(
            system.parameters + 8 * int(offsets[fixed]),
            address(self.gravity),
            system.parameters + 8 * int(offsets[moved]),
            system.parameters + 8 * of_pair,
            address(self.mass_inverse),
        )
        contact = instance["contacts"][int(np.flatnonzero(session.active)[0])]
        coordinates = instance["n_q"] + instance["n_u"]
        self.state = np.append(session.x[:coordinates], session.eta[contact["eta"] :][: contact["room"]])
        self.session = session  # keeps the parameters
        self.call = ctypes.CDLL(str(path)).prototype_steps

    def steps(self, n: int) -> None:
        self.call(
            ctypes.byref(self.kernels),
            ctypes.c_void_p(address(self.state)),
            ctypes.c_double(STEP),
            ctypes.c_long(n),
        )


def both(library: Library, folder: Path, cpu: str) -> tuple[Session, Prototype]:
    session = start(library)
    return session, Prototype(session, compiled_prototype(session, folder, cpu))


def seconds(call: Callable[[int], None]) -> float:
    begun = perf_counter()
    call(STEPS)
    return perf_counter() - begun


def difference(a: Array, b: Array) -> float:
    return float(np.abs(a - b).max())


def times(name: str) -> None:
    """Wall time of one stage of RK4, the least of many short runs of both in turn."""
    with TemporaryDirectory() as folder:
        session, prototype = both(library_of(name), Path(folder), "-march=native")
        session.smooth(1000)
        prototype.steps(1000)
        apart = difference(session.x[:-1], prototype.state)
        pairs = [(seconds(session.smooth), seconds(prototype.steps)) for _ in range(REPEATS)]
        ours, theirs = (1e9 * min(column) / STEPS / STAGES for column in zip(*pairs, strict=True))
    ratio = f"ratio {ours / theirs:.2f}; apart by {apart:.0e}"
    print(f"{name}: core {ours:.0f} ns, prototype {theirs:.0f} ns, {ratio}")


def linked_tori() -> Scene:
    """The scene `linked_rings` with tubes of 2 cm around its circles."""
    ring = make.dynamic(
        "ring",
        make.torus(0.15, 0.02),
        mass=0.3,
        inertia=[0.003375, 0.003375, 0.00675],
        position=[0.0, 0.0, -0.31],
        rpy=[0.0, "pi/2", 0.0],
        velocity=[0.25, 0.15, 0.0],
        angular_velocity=[0.0, -1.0, 0.0],
    )
    hook = make.fixed("hook", make.torus(0.2, 0.02), rpy=["pi/2", 0.0, 0.0])
    return make.scene("linked_tori", [hook, ring], contact=[{"between": ["hook", "ring"]}])


def times_of_run(name: str, library: Library) -> None:
    """CPU time of a run per right-hand side beside the prototype's, the least of runs of all in turn.

    Of a call of `simulate`, and of what the core takes of it, its start included.
    """
    with TemporaryDirectory() as folder:
        session, prototype = both(library, Path(folder), "-march=native")
        session.smooth(100)
        prototype.steps(100)
        state = prototype.state.copy()
        whole, core, theirs = [], [], []
        for _ in range(LINKED_REPEATS):
            begun = process_time()
            path = modelgen.simulate(library, until=LINKED_UNTIL, samples=2, estimate=False)
            whole.append(1e9 * (process_time() - begun) / path.rhs_evals)
            core.append(1e9 * core_seconds_per_evaluation(library))
            prototype.state[:] = state
            theirs.append(1e9 * seconds(prototype.steps) / STEPS / STAGES)
    least = min(theirs)
    for label, times in (("whole run", whole), ("of it the core", core)):
        ratio = f"ratio {min(times) / least:.2f}"
        print(f"{name}, {label}: {min(times):.0f} ns, prototype {least:.0f} ns, {ratio}")


def core_seconds_per_evaluation(library: Library) -> float:
    """CPU time per right-hand side of the core, in a linked run without samples."""
    session = Session(library, accuracy_of(library.manifest.instance, None, {}))
    record = session.tables.Record()
    begun = process_time()
    begin(session)
    session.advance(LINKED_UNTIL, 10**9, record)
    return (process_time() - begun) / int(session.run.rhs_evals)


def counts(name: str) -> None:
    """Instructions of one stage of RK4: the difference of a long and a short run."""
    library = library_of(name)
    with TemporaryDirectory() as text:
        folder = Path(text)
        countable(library, folder)
        compiled_prototype(start(library), folder, COUNTED_CPU)
        ours, theirs = (counted(which, folder) for which in ("core", "prototype"))
    print(f"{name}: instructions: core {ours:.0f}, prototype {theirs:.0f}, ratio {ours / theirs:.2f}")


def counted(which: str, folder: Path) -> float:
    few, many = (callgrind("tests.benchmarks.step_cost", which, folder, n) for n in (1000, 1000 + COUNTED))
    return (many - few) / COUNTED / STAGES


def taken(which: str, folder: Path, n: int) -> None:
    session = start(Library.load(folder))
    if which == "core":
        session.smooth(n)
    else:
        Prototype(session, folder / "prototype.so").steps(n)


def main() -> None:
    for name in SCENES_OF_ONE_BODY:
        times(name)
    times_of_run("linked_rings", library_of("linked_rings"))
    times_of_run("linked tori", built(linked_tori()))
    for name in SCENES_OF_ONE_BODY if shutil.which("valgrind") else ():
        counts(name)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        taken(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]))
    else:
        main()
