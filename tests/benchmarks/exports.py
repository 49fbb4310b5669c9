"""Every shipped scene in each export: what others compile, check and run of it.

python -m tests.benchmarks.exports --out FILE [--only c fmu casadi mjcf] [SCENE ..]

A line of JSON in FILE for each scene and check; what is there is not done again.

c: gcc with sanitizers and zig's clang compile the folder without a warning, and its self-test passes.
fmu: fmpy's validator is silent; co-simulation agrees with `simulate` within the errors that both runs
  state (`of_both`; `of_own`: of what `simulate` alone states); a state that is set again goes on bit for bit.
casadi: the folder loads in a process that cannot import modelgen; functions have equal values.
mjcf: the largest distance of a centre of mass from the run, for steps of 1e-3, 1e-4 and 1e-5 s: below 1e-4 m
  at the last, or the export tells what of the run MuJoCo does not represent.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from modelgen import ModelgenError, derive, read, require, simulate, start
from modelgen.benchmark.peers.mjcf import BLOWS, FACES, different
from modelgen.runtime.error_statement import Estimate
from tests.export.folders import STRICT, ZIG, exported
from tests.export.test_casadi import ALONE
from tests.export.test_fmu import Slave
from tests.running import NAMES, SCENES, scene_of

UNTIL = 0.2  # s, of comparisons with FMUs and MuJoCo; less where a scene ends before
INTERVALS = 10
LIMIT = 300  # s of a self-test
COMPILERS = {
    "gcc": ("gcc", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
    "zig": (*ZIG, "-O1"),
}
UNLIKE = {  # what MuJoCo does not represent, by events of runs in which it matters
    frozenset({"impact", "touch-down"}): BLOWS,
    frozenset({"face-contact"}): FACES,
}
Facts = dict[str, Any]


@cache
def core(compiler: str) -> Path:
    """The core of a C folder, which does not depend on the scene, as an object."""
    folder = Path(tempfile.mkdtemp(prefix=f"modelgen-{compiler}-"))
    exported("bouncing_ball", "c", folder)
    _quiet([*COMPILERS[compiler], *STRICT, "-c", "modelgen_runtime.c", "-o", "core.o"], folder)
    return folder / "core.o"


def in_c(name: str, folder: Path) -> Facts:
    made, facts = exported(name, "c", folder), {}
    for compiler, command in COMPILERS.items():
        built = ["scene.c", "selftest.c", str(core(compiler)), "-lm", "-o", f"selftest-{compiler}"]
        _quiet([*command, *STRICT, *built], made)
        _quiet([*command, *STRICT, "-c", "example.c", "-o", "example.o"], made)
        done = subprocess.run(
            [made / f"selftest-{compiler}"], capture_output=True, text=True, check=False, timeout=LIMIT
        )
        facts[compiler] = done.stderr.strip().splitlines()[-1] if not done.returncode else done.stderr[-2000:]
    return facts | {"good": all("passed" in text for text in facts.values())}


def in_fmus(name: str, folder: Path) -> Facts:
    from fmpy.validation import validate_fmu

    made = exported(name, "fmu", folder, states=True)
    facts: Facts = {}
    until = min(UNTIL, read(SCENES / f"{name}.toml").run.until)
    path = simulate(scene_of(name), until=until, samples=INTERVALS)
    stepped = start(scene_of(name), estimate=True)  # the run of the FMU
    for k in range(INTERVALS):
        stepped.step((k + 1) * until / INTERVALS)
    for version in (2, 3):
        file = str(made / f"{name}.fmi{version}.fmu")
        slave = Slave(file, folder / f"unzipped-{version}")
        names = [each for each in slave.numbers if each.rpartition(".")[2].startswith("position_")]
        bodies = list(dict.fromkeys(each.rpartition(".")[0] for each in names if "." in each))
        moving = [body for body in bodies if body in path.body_names]
        places = [f"{body}.position_{axis}" for body in moving for axis in "xyz"]
        found, same = [slave.get(*places)], True
        for k in range(INTERVALS):
            saved = slave.save()
            slave.step(k * until / INTERVALS, until / INTERVALS)
            found.append(slave.get(*places))
            every = slave.get(*names)
            slave.load(saved)
            slave.step(k * until / INTERVALS, until / INTERVALS)
            same &= slave.get(*names) == every
        expected = path.p[:, [path.body_names.index(body) for body in moving]].reshape(INTERVALS + 1, -1)
        error = np.abs(np.array(found) - expected).max(axis=1)
        own, other = _stated(path.estimate), _stated(stepped.estimate())
        facts[f"fmi{version}"] = {
            "problems": [str(each) for each in validate_fmu(file)],
            "error": float(error.max()),
            "of_own": float(np.max(error / own)),
            "of_both": float(np.max(error / (own + other))),
            "same_bits": bool(same),
        }
    each = [facts["fmi2"], facts["fmi3"]]
    return facts | {"good": all(not x["problems"] and x["same_bits"] and x["of_both"] <= 1 for x in each)}


def _stated(estimate: Estimate | None) -> np.ndarray:
    """m: the error of positions at each sample."""
    return np.full(INTERVALS + 1, np.nan) if estimate is None else estimate.position


def in_casadi(name: str, folder: Path) -> Facts:
    made = exported(name, "casadi", folder)
    functions = json.loads((made / "functions.json").read_text())
    wanted = [*functions["composed"], *list(functions["kernels"])[:1]]
    derivation, worst = derive(require(read(SCENES / f"{name}.toml"))), 0.0
    own = {formula.function.name(): formula.function for formula in derivation.formulas}
    own |= {function: derivation.rhs() for function in functions["composed"]}
    for function in wanted:
        told = subprocess.run(
            [sys.executable, "-c", ALONE, str(made), function],
            capture_output=True,
            text=True,
            check=True,
            cwd=folder,
        ).stdout.split()
        f = own[function]
        values = f.call([0.1 + 0.01 * k for k in range(f.n_in())])
        expected = np.concatenate([np.array(value.full()).ravel() for value in values])
        found = np.array(told[1:], dtype=float)
        worst = max(worst, float(np.nanmax(np.abs(found - expected) / (1.0 + np.abs(expected)), initial=0.0)))
        assert int(told[0]) == len(functions["kernels"]) + len(functions["composed"])
        assert (np.isnan(found) == np.isnan(expected)).all()
    return {"functions": len(own), "worst": worst, "good": worst < 1e-12}


def in_mjcf(name: str, folder: Path) -> Facts:
    import mujoco

    until = min(UNTIL, read(SCENES / f"{name}.toml").run.until)
    path, errors = simulate(scene_of(name), until=until, samples=INTERVALS), []
    for step in (1e-3, 1e-4, 1e-5):
        model = mujoco.MjModel.from_xml_path(str(exported(name, "mjcf", folder, step=step) / f"{name}.xml"))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        mujoco.mj_step(model, data, nstep=round(until / step))
        moving = [k for k, body in enumerate(path.body_names) if model.body(body).dofnum[0]]
        found = np.array([data.xipos[model.body(path.body_names[k]).id] for k in moving])
        errors.append(float(np.abs(found - path.p[-1, moving]).max()))
    events = sorted({event.kind for event in path.events})
    told = different(read(SCENES / f"{name}.toml"))
    unlike = [note for kinds, note in UNLIKE.items() if note in told and kinds & {*events}]
    return {"errors": errors, "events": events, "unlike": unlike, "good": errors[-1] < 1e-4 or bool(unlike)}


CHECKS: dict[str, Callable[[str, Path], Facts]] = {
    "c": in_c, "fmu": in_fmus, "casadi": in_casadi, "mjcf": in_mjcf
}  # fmt: skip


def checked(check: str, name: str) -> Facts:
    """What a check finds, or why there is no such export."""
    with tempfile.TemporaryDirectory(prefix="modelgen-") as folder:
        try:
            return CHECKS[check](name, Path(folder))
        except ModelgenError as refused:
            return {"refused": str(refused)}
        except (AssertionError, subprocess.SubprocessError) as failed:
            return {"good": False, "failed": str(failed)[-2000:]}


def _quiet(command: Sequence[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]
    assert not done.stderr, done.stderr[:2000]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", default=NAMES)
    parser.add_argument("--only", nargs="+", default=list(CHECKS), choices=list(CHECKS))
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    lines = options.out.read_text().splitlines() if options.out.exists() else []
    done = {(line["check"], line["scene"]) for line in map(json.loads, lines)}
    for check in options.only:
        for name in options.scenes:
            if (check, name) in done:
                continue
            began = time.monotonic()
            facts = {"check": check, "scene": name, **checked(check, name), "s": time.monotonic() - began}
            with options.out.open("a") as file:
                file.write(json.dumps(facts) + "\n")
            print(json.dumps(facts), flush=True)


if __name__ == "__main__":
    main()
