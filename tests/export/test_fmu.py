"""`--to fmu`: both FMUs are valid, and run as `simulate` does."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelgen import simulate
from modelgen.codegen.compiler import FLAGS
from modelgen.errors import ModelgenError
from modelgen.export import fmu
from tests.c_compiler import needs_c
from tests.export.folders import exported
from tests.running import scene_of

fmpy = pytest.importorskip("fmpy")

VERSIONS = pytest.mark.parametrize("version", [2, 3])
PUSH = {"torque": 1.5}  # N m


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Compiled without optimisation, which takes a third of the time."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(fmu, "portable_flags", lambda compiler, real: ("-O0", *FLAGS))
        yield exported("balancing_wheel", "fmu", tmp_path_factory.mktemp("fmus"), states=True)


def archive(fmus: Path, version: int) -> str:
    return str(fmus / f"balancing_wheel.fmi{version}.fmu")


class Slave:
    """An FMU that has been started; numbers of its variables by name."""

    def __init__(
        self, file: str, folder: Path, inputs: dict[str, float] | None = None, start: bool = True
    ) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        described = read_model_description(file)
        self.is_2 = described.fmiVersion.startswith("2")
        self.numbers = {each.name: each.valueReference for each in described.modelVariables}
        given = {
            "guid": described.guid or described.instantiationToken,
            "unzipDirectory": extract(file, unzipdir=str(folder)),
            "modelIdentifier": described.coSimulation.modelIdentifier,
            "instanceName": "one",
        }
        self.fmu: Any = (FMU2Slave if self.is_2 else FMU3Slave)(**given)
        if not start:
            return
        if self.is_2:
            self.fmu.instantiate()
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.instantiate(earlyReturnAllowed=False)
            self.fmu.enterInitializationMode(startTime=0.0)
        for name, value in (inputs or {}).items():
            self.set(name, value)
        self.fmu.exitInitializationMode()

    def set(self, name: str, value: float) -> None:
        (self.fmu.setReal if self.is_2 else self.fmu.setFloat64)([self.numbers[name]], [value])

    def get(self, *names: str) -> list[float]:
        numbers = [self.numbers[name] for name in names]
        return list((self.fmu.getReal if self.is_2 else self.fmu.getFloat64)(numbers))

    def step(self, t: float, h: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)

    def save(self) -> Any:
        return self.fmu.getFMUstate() if self.is_2 else self.fmu.getFMUState()

    def load(self, state: Any) -> None:
        (self.fmu.setFMUstate if self.is_2 else self.fmu.setFMUState)(state)

    def bytes_of(self, state: Any) -> bytes:
        return bytes((self.fmu.serializeFMUstate if self.is_2 else self.fmu.serializeFMUState)(state))

    def state_of(self, data: bytes) -> Any:
        return (self.fmu.deSerializeFMUstate if self.is_2 else self.fmu.deserializeFMUState)(data)


@needs_c
@VERSIONS
def test_an_fmu_is_valid_and_holds_its_sources(fmus: Path, version: int) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(archive(fmus, version)) == []
    names = zipfile.ZipFile(archive(fmus, version)).namelist()
    assert {"sources/scene.c", "sources/modelgen_runtime.c", f"sources/fmi{version}.c"} <= set(names)


@needs_c
@VERSIONS
def test_an_fmu_runs_as_simulate_does(fmus: Path, version: int, tmp_path: Path) -> None:
    """Steps of the importer cut those of the run short, so that the two differ within the run's estimate."""
    intervals, until = 20, 1.0
    path = simulate(scene_of("balancing_wheel"), until=until, samples=intervals, inputs=PUSH)
    slave, told = Slave(archive(fmus, version), tmp_path, PUSH), []
    names = [f"wheel.position_{axis}" for axis in "xyz"]
    told.append(slave.get(*names))
    for k in range(intervals):
        slave.step(k * until / intervals, until / intervals)
        told.append(slave.get(*names))
    wheel = path.body_names.index("wheel")
    assert path.estimate is not None
    allowed = 10 * path.estimate.position + 1e-12
    assert (np.abs(np.array(told) - path.p[:, wheel]).max(axis=1) <= allowed).all()


@needs_c
@VERSIONS
def test_a_saved_state_goes_on_bit_for_bit_also_in_another_instance(
    fmus: Path, version: int, tmp_path: Path
) -> None:
    first = Slave(archive(fmus, version), tmp_path / "a", PUSH)
    second = Slave(archive(fmus, version), tmp_path / "b")
    names = [name for name in first.numbers if name not in ("time", "torque")]
    first.step(0.0, 0.2)
    state = first.save()
    data = first.bytes_of(state)
    first.step(0.2, 0.1)
    then = first.get(*names)
    assert first.get("time") == [0.30000000000000004]
    first.load(state)
    assert first.get("time") == [0.2]
    first.step(0.2, 0.1)
    second.load(second.state_of(data))
    second.step(0.2, 0.1)
    assert then == first.get(*names) == second.get(*names)


@needs_c
@VERSIONS
def test_a_value_outside_of_the_range_of_its_input_is_refused(
    fmus: Path, version: int, tmp_path: Path
) -> None:
    slave = Slave(archive(fmus, version), tmp_path)
    slave.set("torque", -20.0)
    with pytest.raises(Exception, match="failed with status 3"):
        slave.set("torque", 20.5)
    with pytest.raises(Exception, match="failed with status 3"):
        slave.set("axle_x", 0.0)


def test_a_scene_that_shows_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelgenError, match="no sensors: the FMU would show nothing; add"):
        exported("ball_in_bowl", "fmu", tmp_path)


@needs_c
@pytest.mark.slow
def test_an_fmu_of_a_scene_with_impacts_returns_early_at_each(tmp_path: Path) -> None:
    exported("bouncing_ball", "fmu", tmp_path, states=True)
    slave = Slave(str(tmp_path / "bouncing_ball.fmi3.fmu"), tmp_path / "x", start=False)
    slave.fmu.instantiate(earlyReturnAllowed=True)
    slave.fmu.enterInitializationMode(startTime=0.0)
    slave.fmu.exitInitializationMode()
    t, early, until = 0.0, [], 1.0
    while t < until:
        _, _, is_early, reached = slave.fmu.doStep(
            currentCommunicationPoint=t, communicationStepSize=until - t
        )
        assert reached > t
        t = reached
        early += [t] if is_early else []
    path = simulate(scene_of("bouncing_ball"), until=until)
    assert path.estimate is not None
    impacts = [event.t for event in path.events if event.kind == "impact"]
    assert len(early) == len(impacts) > 0
    assert np.abs(np.array(early) - impacts).max() <= 10 * (path.estimate.events or 0.0) + 1e-9
