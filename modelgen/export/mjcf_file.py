"""`--to mjcf`: a scene as MuJoCo's XML, with its start as the keyframe `start`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from modelgen.benchmark.knobs import Settings
from modelgen.benchmark.peers.mjcf import Mjcf, different, motors, unlike
from modelgen.benchmark.peers.scene_description import Setup, tabulated
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.rotations import rotation_of
from modelgen.runtime.core_session import Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from modelgen.scene.scene_types import Scene

REMEDY = "export --to c or fmu"
STEP = 1e-4  # s, unless the scene has a step of its own
CHOICES: Settings = {  # with the native collider two ellipsoids drift apart from the run as the step shrinks
    "integrator": "RK4", "solver": 1e-12, "contact": "tied", "segments": 512, "tube": 1e-3,
    "collider": "libccd", "ccd": 1e-12,
}  # fmt: skip


def check_mjcf(scene: Scene) -> None:
    """Raises ModelgenError that names what of a scene MuJoCo has no like of."""
    refused = unlike(scene) + _unsteady(scene)
    if refused:
        raise ModelgenError(scene.source, "; ".join(refused), "MJCF has no like of it", REMEDY)


def mjcf_files(scene: Scene, library: Library, step: float | None) -> dict[str, str]:
    """`NAME.xml` of a scene that `check_mjcf` lets pass.

    `step`: of the simulation, s, on which the stiffness of contacts depends.
    """
    setup = setup_of(scene, library)
    notes = "\n".join(f"     - {note}" for note in different(scene)) or "     - nothing"
    text = Mjcf(setup, CHOICES, step or scene.run.step or STEP).text()
    start = f"<keyframe>{_start(setup)}</keyframe></mujoco>"
    head = f"<!-- {scene.name}, exported by modelgen. MuJoCo represents otherwise:\n{notes}\n-->\n"
    return {f"{scene.name}.xml": head + text.replace("</mujoco>", start) + "\n"}


def setup_of(scene: Scene, library: Library) -> Setup:
    """The bodies as the run starts, after its start has been settled."""
    instance = library.manifest.instance
    session = Session(library, accuracy_of(instance, None, {}))
    recording = Recording(session, np.zeros(1))
    begin(session)
    if session.start_code:
        raise ModelgenError(scene.source, "its start is refused", "", "run `modelgen simulate` to see why")
    session.advance(0.0, 0, recording.record)
    columns: Mapping[str, np.ndarray] = recording.columns()
    start = tuple(columns[name][0].astype(float) for name in ("p", "quaternion", "v", "w"))
    return Setup.started(scene, instance, start, scene.run.until, scene.run.samples)


def _unsteady(scene: Scene) -> list[str]:
    """Loads that a keyframe, which holds constants, cannot have."""
    return [
        f"load {k} depends on time"
        for k, load in enumerate(motors(scene))
        if any(component.names for component in load.components)
    ]


def _start(setup: Setup) -> str:
    """The state at the start: positions, quaternions; velocities, angular velocities in body axes; motors."""
    q, u = [], []
    for solid in setup.moving:
        w, x, y, z = (float(part) for part in solid.quaternion)
        q += [*solid.p, *solid.quaternion]
        u += [*solid.v, *(rotation_of((w, x, y, z)).T @ solid.w)]
    values = {"qpos": q, "qvel": u}
    loads = motors(setup.scene)
    if loads:
        values["ctrl"] = [each for load in loads for each in tabulated(load.components, np.zeros(1))[0]]
    words = {key: " ".join(repr(float(value)) for value in each) for key, each in values.items()}
    told = " ".join(f'{key}="{text}"' for key, text in words.items() if text)
    return f'<key name="start" {told}/>'
