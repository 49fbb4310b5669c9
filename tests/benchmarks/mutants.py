"""Damaged files and texts: `python -m tests.benchmarks.mutants KIND [--count N] [--part 1/2] [--case 17]`.

checkpoints: saved states of runs and of groups of runs; none that was damaged may be loaded.
runs: files of runs; what is read is what was written, or the file is refused.
imports: MJCF, URDF, meshes, profiles, recordings and .npz through `import`, and through `check` if accepted.
sweeps: folders of sweeps, through `plot` and through the command that goes on with the sweep: what they
give is what the sweep gave, or the folder is refused.
messages: to the live page, which goes on; nothing is printed.
scenes: texts of scenes through `check`.

A case is a fault if it ends in a traceback or a signal, uses more than 10 s of CPU time or 6 GB of memory,
prints beside its message, or answers with more than a short message of one line. Cases run one after
another in a process that is replaced when it dies; the number of a case decides it, and `--case` runs one
and shows its traceback. The exit code is 1 if there are faults.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import shutil
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from math import ceil
from multiprocessing.connection import Connection
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory, TemporaryFile
from typing import Any

import numpy as np
from click.testing import CliRunner

import modelgen
from modelgen import ModelgenError, load_sweep, read, record_of, simulate, start, start_many
from modelgen.cli.command_group import app
from modelgen.parameter_study import sweep_folder
from modelgen.report.run_files import load, save
from modelgen.report.run_record import Record
from tests.mutants import damaged, text_mutant
from tests.running import FILES, SCENES, scene_of

MOST_CPU_S, MOST_BYTES = 10, 6 * 2**30
LONGEST = 1000  # characters of a message
Judge = Callable[[int], str]  # of the number of a case: what came of it
REFUSED, ACCEPTED, SAME = "refused", "accepted", "read as it was"


class FaultError(Exception):
    """A case is not as it should be."""


def told(*words: object) -> str:
    """How a command in this process ends: REFUSED or ACCEPTED. Raises FaultError, or what it raises."""
    answer = CliRunner().invoke(app, [str(word) for word in words])
    if answer.exception is not None and not isinstance(answer.exception, SystemExit):
        raise answer.exception
    if answer.exit_code not in (0, 2):
        raise FaultError(f"exit code {answer.exit_code}: {answer.stderr[-200:]}")
    if answer.exit_code == 2 and (answer.stderr.count("\n") != 1 or len(answer.stderr) > LONGEST):
        raise FaultError(f"a message of {len(answer.stderr)} characters: {answer.stderr[:300]}")
    if answer.exit_code == 0 and "Warning" in answer.stderr:
        raise FaultError(answer.stderr[:300])
    return REFUSED if answer.exit_code else ACCEPTED


def of_checkpoints(_: Path) -> Judge:
    """Runs that rest, fly, step in time and are driven, and groups of them."""
    libraries = [scene_of(name) for name in ("bouncing_ball", "balancing_wheel", "glass_on_table", "gripper")]
    made: list[Any] = []
    for library in libraries:
        made += [start(library), start_many(library, 3), start(library, method="time-stepping", step=1e-3)]
    for each in made:
        each.step(0.1)
    saved = [each.save() for each in made]

    def judge(case: int) -> str:
        run, whole = made[case % len(made)], saved[case % len(made)]
        mutant = damaged(whole, Random(case), case // len(made))
        if mutant == whole:
            return SAME
        try:
            run.load(mutant)
        except ModelgenError as error:
            check_message(error)
        else:
            raise FaultError("a damaged state was loaded")
        if run.save() != whole:
            raise FaultError("the run is not as it was")
        return REFUSED

    return judge


def of_runs(folder: Path) -> Judge:
    wholes, records = [], []
    path = folder / "run.npz"
    for name in ("bouncing_ball", "glass_on_table", "four_bar", "balancing_wheel"):
        library, scene = scene_of(name), read(SCENES / f"{name}.toml")
        save(record_of(simulate(library, until=0.2, samples=20), library, scene), path)
        wholes.append(path.read_bytes())
        records.append(load(path))

    def judge(case: int) -> str:
        whole, own = wholes[case % 4], records[case % 4]
        path.write_bytes(damaged(whole, Random(case), case // 4))
        try:
            found = load(path)
        except ModelgenError as error:
            check_message(error)
            return told("plot", path, "--out", folder / "run.png") if case % 16 == 0 else REFUSED
        if not is_same(found, own):
            raise FaultError("a run was read that is not the one that was written")
        return SAME

    return judge


def is_same(a: Record, b: Record) -> bool:
    """Whether two runs hold the same, to the last bit."""
    arrays = [(a.columns, b.columns), (a.meshes, b.meshes), (a.faces, b.faces)]
    rest = [
        (r.summary, r.scene, r.body_names, r.contact_names, r.joint_names, r.sensor_names, r.shares)
        for r in (a, b)
    ]
    return str(rest[0]) == str(rest[1]) and all(
        x.keys() == y.keys() and all(np.array_equal(x[key], y[key], equal_nan=True) for key in x)
        for x, y in arrays
    )


def check_message(error: ModelgenError) -> None:
    if "\n" in str(error) or len(str(error)) > LONGEST:
        raise FaultError(f"a message of {len(str(error))} characters: {str(error)[:300]}")


MJCF = """<mujoco model="m"><compiler angle="radian"/><option timestep="0.001" gravity="0 0 -9.81"/>
<asset><mesh name="hull" file="hull.stl" scale="1 1 1"/><mesh name="text" file="hull.obj"/>
<hfield name="field" nrow="2" ncol="3" size="1 1 0.1 0.1" elevation="0 1 0 1 0 1"/></asset>
<default><geom friction="0.5 0.005 0.0001" density="900"/></default>
<worldbody><geom name="floor" type="plane" size="1 1 1"/>
<body name="arm" pos="0 0 1"><joint name="hinge" type="hinge" axis="0 1 0" range="-1 1" damping="0.1"/>
<geom type="capsule" size="0.02" fromto="0 0 0 0.2 0 0"/>
<body name="hand" pos="0.3 0 0"><joint name="slide" type="slide" axis="1 0 0" stiffness="20"/>
<geom type="mesh" mesh="hull"/><site name="tip" pos="0.1 0 0"/></body></body>
<body name="free" pos="1 0 1" quat="1 0 0 0"><freejoint/><geom type="mesh" mesh="text"/></body>
<body name="ball" pos="1 1 1"><freejoint/><geom type="ellipsoid" size="0.1 0.2 0.3"/></body></worldbody>
<actuator><motor name="push" joint="hinge" gear="2" ctrlrange="-1 1"/></actuator>
<equality><connect body1="free" body2="ball" anchor="0 0 0.1"/></equality>
<sensor><jointpos joint="hinge"/></sensor><keyframe><key name="home" qpos="0 0 1 0 1 1 0 0 0 1 1 1 1 0 0 0"/>
</keyframe></mujoco>
"""
URDF = """<robot name="r">
<link name="base"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial><collision><geometry><mesh filename="hull.stl" scale="1 1 1"/></geometry></collision></link>
<link name="arm"><inertial><origin xyz="0.1 0 0" rpy="0 0 0"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>
<collision><geometry><mesh filename="package://r/hull.obj"/></geometry></collision></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="10" velocity="2"/><dynamics damping="0.1"/></joint>
</robot>
"""
CORNERS = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
TRIANGLES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)


def binary_stl() -> bytes:
    corners = np.zeros(len(TRIANGLES), dtype=[("normal", "<3f4"), ("corners", "<9f4"), ("color", "<u2")])
    corners["corners"] = CORNERS[TRIANGLES].reshape(-1, 9)
    return bytes(80) + len(TRIANGLES).to_bytes(4, "little") + corners.tobytes()


def text_stl() -> str:
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in CORNERS[each])
        + "endloop\nendfacet\n"
        for each in TRIANGLES
    )
    return f"solid hull\n{facets}endsolid hull\n"


def obj() -> str:
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    return points + "".join(f"f {a} {b} {c}\n" for a, b, c in TRIANGLES + 1)


def profile(count: int = 200) -> str:
    angle = 2 * np.pi * np.arange(count) / count
    return "x,y\n" + "".join(f"{0.2 + 0.1 * np.cos(t):.9g},{0.05 * np.sin(t):.9g}\n" for t in angle)


def arc(count: int = 200) -> str:
    angle = np.linspace(0.3, 1.2, count)
    return "r,z\n" + "".join(f"{0.3 * np.cos(t):.9g},{0.3 * np.sin(t):.9g}\n" for t in angle)


ODD_PROFILES = (
    *("", "\n\n", "x,y\n", ",\n,\n", "0,0\n1,\n2,3\n", "\0", "x,y\n" + "1,1\n" * 99, "0,0\n1e-320,0\n" * 50),
    *("\n".join(f"{k},{2 * k}" for k in range(99)), "\n".join(f"{k}e302,{k * k % 7}e302" for k in range(99))),
    *("\n".join(f"{k}e-310,{k * k % 7}e-310" for k in range(99)), '"\n' * 99, ("1," * 10**5 + "\n") * 3),
    "\n".join(f"{k / 9 if k < 50 else 11 - k / 9},{k // 50 * 1e-7}" for k in range(100)),
)


def of_imports(folder: Path) -> Judge:
    own = folder / "import"
    npz = folder / "run.npz"
    library = scene_of("bouncing_ball")
    save(record_of(simulate(library, until=0.2, samples=5), library), npz)
    kinds: dict[str, tuple[str, str | bytes, tuple[str, ...]]] = {
        "mjcf": ("m.xml", MJCF, ()),
        "urdf": ("r.urdf", URDF, ()),
        "urdf floating": ("r.urdf", URDF, ("--floating",)),
        "text stl": ("hull.stl", text_stl(), ()),
        "binary stl": ("hull.stl", binary_stl(), ()),
        "obj": ("hull.obj", obj(), ()),
        "revolution": ("p.csv", arc(), ("--as", "revolution")),
        "profile_wall": ("p.csv", arc(), ("--as", "profile_wall", "--columns", "r,z")),
        "extrusion": ("p.csv", profile(), ("--as", "extrusion", "--tolerance", "1e-6")),
        "npz": ("run.npz", npz.read_bytes(), ()),
        "npz as mjcf": ("run.npz", npz.read_bytes(), ("--format", "mjcf")),
        "npz as profile": ("run.npz", npz.read_bytes(), ("--format", "profile", "--as", "extrusion")),
    }
    names = list(kinds)

    def judge(case: int) -> str:
        draw, number = Random(case), case // len(names)
        name, whole, options = kinds[names[case % len(names)]]
        shutil.rmtree(own, ignore_errors=True)
        own.mkdir()
        for file, content in (("hull.stl", binary_stl()), ("hull.obj", obj().encode())):
            (own / file).write_bytes(content)
        if name == "p.csv" and number < len(ODD_PROFILES):
            content = ODD_PROFILES[number].encode()
        else:
            content = (
                text_mutant(whole, draw, number) if isinstance(whole, str) else damaged(whole, draw, number)
            )
        (own / name).write_bytes(content)
        if name.startswith("hull"):
            name = ("m.xml", "r.urdf")[number % 2]
            (own / name).write_text((MJCF, URDF)[number % 2])
        found = told("import", own / name, *options, "--out", own / "scene.toml")
        if found == ACCEPTED:
            return f"{ACCEPTED}, then {told('check', '--brief', own / 'scene.toml')}"
        if (own / "scene.toml").exists():
            raise FaultError("refused, and a scene was written")
        return found

    return judge


def of_sweeps(folder: Path) -> Judge:
    from tests.parameter_study.scenes import BALL

    scene = folder / "ball.toml"
    scene.write_text(BALL)
    words = ("--vary", "height=0.02:0.3:4", "--vary", "push=0,1", "--until", "0.1", "--no-estimate")
    os.chdir(folder)
    whole, cut, own = folder / "whole", folder / "cut", folder / "own"
    assert told("sweep", scene, *words, "--out", whole) == ACCEPTED
    columns = load_sweep(whole).columns
    leave_parts(whole, cut)
    files = {each: sorted(path for path in each.rglob("*") if path.is_file()) for each in (whole, cut)}

    def judge(case: int) -> str:
        draw, number = Random(case), case // 2
        source = (whole, cut)[case % 2]
        shutil.rmtree(own, ignore_errors=True)
        shutil.copytree(source, own)
        damage(own, [own / path.relative_to(source) for path in files[source]], draw, number)
        found = told("plot", own, "--out", folder / "sweep.png")
        if found == ACCEPTED and not is_part(load_sweep(own).columns, columns):
            raise FaultError("a table was read that is not the one that was written")
        went_on = told("sweep", scene, *words, "--out", own)
        if went_on == ACCEPTED and str(dict(load_sweep(own).columns)) != str(dict(columns)):
            raise FaultError("the command that went on gave another table")
        return f"plot {found}, sweep {went_on}"

    return judge


def leave_parts(whole: Path, cut: Path) -> None:
    """The folder of a sweep that was interrupted when five runs were done."""
    import pyarrow.parquet

    (cut / sweep_folder.PARTS).mkdir(parents=True)
    shutil.copy(whole / sweep_folder.PLAN, cut)
    table = pyarrow.parquet.read_table(whole / sweep_folder.TABLE)
    for first, size in ((0, 1), (1, 2), (3, 2)):
        path = cut / sweep_folder.PARTS / f"{first:07d}-{first + size - 1:07d}.parquet"
        pyarrow.parquet.write_table(table.slice(first, size), path, write_page_checksum=True)


ODD_PLANS = (
    b"{}",
    b"[]",
    b"",
    b"null",
    b"[" * 10**5,
    b'{"digest":' * 10**5,
    b"1" * 10**5,
    b'{"runs": 1e999}',
)


def damage(folder: Path, files: Sequence[Path], draw: Random, kind: int) -> None:
    """Damage the folder of a sweep: its plan, a table, or names of files."""
    plan, one, other = folder / sweep_folder.PLAN, draw.choice(files), draw.choice(files)
    match kind % 10:
        case 0:
            plan.write_bytes(draw.choice(ODD_PLANS))
        case 1:
            plan.write_bytes(text_mutant(plan.read_text(encoding="utf-8"), draw, draw.randrange(16)))
        case 2 | 3 | 4:
            one.write_bytes(damaged(one.read_bytes(), draw, draw.randrange(7)))
        case 5:
            one.unlink()
        case 6:
            content = one.read_bytes()
            one.write_bytes(other.read_bytes())
            other.write_bytes(content)
        case 7:
            first = draw.randrange(8)
            name = f"{first:07d}-{first + draw.randrange(4):07d}.parquet"
            (folder / sweep_folder.PARTS).mkdir(exist_ok=True)
            (folder / sweep_folder.PARTS / name).write_bytes(one.read_bytes())
        case 8:
            one.unlink()
            one.mkdir()
        case 9:
            one.unlink()
            one.symlink_to(draw.choice(("nowhere", one.name, "/dev/null", str(other))))


def is_part(found: Mapping[str, Sequence[Any]], whole: Mapping[str, Sequence[Any]]) -> bool:
    """Whether rows are those of a whole table, each once."""
    runs = list(found["run"])
    return len(set(runs)) == len(runs) and all(
        str(list(found[name])) == str([whole[name][run] for run in runs]) for name in whole
    )


def of_messages(_: Path) -> Judge:
    import viser
    from websockets import Subprotocol
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    from modelgen import require
    from modelgen.view.live_server import Live
    from tests.view.malformed_messages import malformed

    library, model = scene_of("balancing_wheel"), require(read(SCENES / "balancing_wheel.toml"))
    served: list[Live] = []

    def judge(case: int) -> str:
        if not served:  # in the process of the cases
            served.append(Live(library, model, port=18100))
        (live,) = served
        address = live.address.replace("http", "ws")
        with (
            connect(address, subprotocols=[Subprotocol(f"viser-v{viser.__version__}")]) as line,
            suppress(ConnectionClosed),
        ):
            line.send(malformed(live, np.random.default_rng(case)))
        live.step(0.001)
        if live.simulation.outcome is not None or not np.isfinite(live.simulation.state).all():
            raise FaultError("the run ended")
        return "the page went on"

    return judge


def of_scenes(folder: Path) -> Judge:
    templates = Path(modelgen.__file__).parent / "scene" / "templates"
    texts = [path.read_text(encoding="utf-8") for path in (*FILES, *sorted(templates.glob("*.toml")))]
    path = folder / "scene.toml"

    def judge(case: int) -> str:
        path.write_bytes(text_mutant(texts[case % len(texts)], Random(case), case // len(texts)))
        return told("check", path, *(("--json",) if case % 2 else ()))

    return judge


STUDIES: dict[str, tuple[Callable[[Path], Judge], int]] = {
    "checkpoints": (of_checkpoints, 10_000),
    "runs": (of_runs, 5_000),
    "imports": (of_imports, 3_000),
    "sweeps": (of_sweeps, 500),
    "messages": (of_messages, 1_000),
    "scenes": (of_scenes, 5_000),
}


def answers(judge: Judge, cases: Sequence[int]) -> Iterator[tuple[int, str, str]]:
    """Each case, what came of it, and the fault, empty where there is none."""
    left = list(cases)
    context = multiprocessing.get_context("fork")
    while left:
        reads, writes = context.Pipe(duplex=False)
        worker = context.Process(target=work, args=(judge, left, writes))
        worker.start()
        writes.close()
        with suppress(EOFError):
            while True:
                found, fault = reads.recv()
                yield left.pop(0), found, fault
        worker.join()
        if left:
            yield left.pop(0), "", _ending(worker.exitcode or 0)


def _ending(code: int) -> str:
    name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
    return (
        f"more than {MOST_CPU_S} s of CPU time" if code == -signal.SIGXCPU else f"the process ended: {name}"
    )


def work(judge: Judge, cases: Sequence[int], to: Connection) -> None:
    """Judge cases in this process, which is killed by one that takes too long."""
    with TemporaryFile() as printed:
        os.dup2(printed.fileno(), 2)
        resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
        for case in cases:
            before = os.fstat(printed.fileno()).st_size
            resource.setrlimit(
                resource.RLIMIT_CPU, (ceil(time.process_time()) + MOST_CPU_S, resource.RLIM_INFINITY)
            )
            try:
                found, fault = judge(case), ""
            except BaseException as error:
                found, fault = "", _told(error)
            more = os.pread(printed.fileno(), LONGEST, before)
            if more and not fault:
                fault = f"printed: {more!r}"
            to.send((found, fault))


def _told(error: BaseException) -> str:
    if isinstance(error, FaultError):
        return str(error)
    last = traceback.extract_tb(error.__traceback__)[-1]
    own = [each for each in traceback.extract_tb(error.__traceback__) if "modelgen" in each.filename]
    place = "".join(f"{Path(each.filename).name}:{each.lineno} " for each in (*own[-2:], last))
    return f"traceback: {type(error).__name__}: {str(error)[:200]} at {place}"


def study(kind: str, cases: Sequence[int]) -> list[tuple[int, str]]:
    """Judge cases; print what came of them. Returns the faults."""
    with TemporaryDirectory() as name:
        folder = Path(name).resolve()
        os.chdir(folder)
        judge = STUDIES[kind][0](folder)
        counts, faults = Counter[str](), []
        for case, found, fault in answers(judge, cases):
            counts[found or "FAULT"] += 1
            if fault:
                faults.append((case, fault))
                print(f"{kind} {case}: {fault}", flush=True)
    for found, count in counts.most_common():
        print(f"{kind:12} {found:40} {count:6}")
    return faults


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=STUDIES)
    parser.add_argument("--count", type=int)
    parser.add_argument("--part", default="1/1")
    parser.add_argument("--case", type=int)
    given = parser.parse_args()
    if given.case is not None:
        with TemporaryDirectory() as name:
            os.chdir(name)
            print(STUDIES[given.kind][0](Path(name).resolve())(given.case))
        return 0
    part, parts = map(int, given.part.split("/"))
    cases = range(part - 1, STUDIES[given.kind][1] if given.count is None else given.count, parts)
    return int(bool(study(given.kind, cases)))


if __name__ == "__main__":
    sys.exit(main())
