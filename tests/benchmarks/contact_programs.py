"""modelgen, MuJoCo and Bullet as programs that run a task, step by step where somebody watches."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import process_time
from typing import Any, Protocol

import numpy as np

from modelgen import build, derive, emit, require, start
from modelgen.benchmark.peers.mjcf import geom_size, words
from modelgen.benchmark.peers.scene_description import numbers
from modelgen.codegen.library import Library
from modelgen.rotations import rotation_of
from modelgen.runtime.core_session import CONTINUE, FULL
from modelgen.runtime.settings import Stepping
from modelgen.scene.scene_types import Body, Scene
from tests.benchmarks.contact_tasks import HELD, Task

Array = Any  # numpy's
Watch = Callable[[], None]
WATCHED = 0.01  # s, between two looks at a program of shorter steps
PEER_STEP, BULLET_STEP = 0.002, 1 / 240  # s; MuJoCo's and Bullet's defaults
MANY_STEPS = 1_000_000


class Run(Protocol):
    """A run of a task from its start on."""

    def go(self, watch: Watch | None) -> None:
        """To the end; `watch` is called at ends of steps."""

    def poses(self) -> tuple[Array, Array]:
        """Of all bodies of the scene: (nb, 3) where their frames lie, (nb, 3, 3) how they are turned."""

    def contacts(self) -> int:
        """Their number at present."""

    @property
    def t(self) -> float: ...

    @property
    def steps(self) -> int: ...

    @property
    def failure(self) -> str:
        """Why it ended early; empty: it did not."""


class Modelgen:
    """A run of modelgen; `library` is that of the scene."""

    def __init__(self, task: Task, library: Library, accuracy: str, stepping: Stepping) -> None:
        self._task = task
        self._run = start(library, accuracy=accuracy, **stepping)
        bodies = library.manifest.instance["bodies"]
        place = {body["name"]: k for k, body in enumerate(bodies)}
        self._order = [place[body.name] for body in task.scene.bodies]
        self._centre = np.array([bodies[k]["centre_of_mass"] for k in self._order])
        self._inputs = [each["name"] for each in library.manifest.instance["inputs"]]

    def go(self, watch: Watch | None) -> None:
        if self._task.controls is None:
            session, most = self._run.session, MANY_STEPS if watch is None else 1
            record, self._code = session.tables.Record(), CONTINUE
            while self._code in (CONTINUE, FULL):
                self._code = session.advance(self._task.until, most, record)
                session.drain_events()
                if watch:
                    watch()
            return
        for k, values in enumerate(self._task.controls.tolist()):
            self._run.inputs.update(zip(self._inputs, values, strict=True))
            self._run.step((k + 1) * HELD)
            if watch:
                watch()
            if self._run.outcome is not None:
                return

    def poses(self) -> tuple[Array, Array]:
        poses = self._run.session.poses()[self._order]
        turned = np.swapaxes(poses[:, 3:].reshape(-1, 3, 3), 1, 2)
        return poses[:, :3] - np.einsum("nij,nj->ni", turned, self._centre), turned

    def contacts(self) -> int:
        return int((np.nan_to_num(self._run.session.force) > 0).sum())

    @property
    def t(self) -> float:
        return self._run.t

    @property
    def steps(self) -> int:
        return int(self._run.session.run.steps)

    @property
    def failure(self) -> str:
        if self._run.outcome is not None:
            return self._run.outcome.name.lower()
        return "" if self.t >= self._task.until * (1 - 1e-9) else f"code {self._code}"


def library_of(task: Task, folder: str) -> tuple[Library, float]:
    """The library of a scene, and the CPU time that it took with its kinds compiled, s."""
    begun = process_time()
    library = build(emit(derive(require(task.scene))), folder=folder)
    return library, process_time() - begun


def mjcf(scene: Scene) -> str:
    """The same free bodies for MuJoCo, with its own contacts between all of them."""
    text, friction = "", friction_of(scene)
    for body in scene.bodies:
        (shape,), pose = body.shapes, body.pose
        size = words((5, 5, 1) if shape.kind == "plane" else geom_size(shape))
        free = "<freejoint/>" if body.motion == "dynamic" else ""
        touch = f'density="{body.density or 0}" friction="{friction} 0 0"'
        geom = f'<geom type="{shape.kind}" size="{size}" {touch}/>'
        frame = f'name="{body.name}" pos="{words(pose.position)}" quat="{words(pose.quaternion)}"'
        text += f"<body {frame}>{free}{geom}</body>"
    return f'<mujoco><size memory="1G"/><worldbody>{text}</worldbody></mujoco>'


def friction_of(scene: Scene) -> float:
    """That of all contacts."""
    (found,) = {pair.friction.kinetic[0] if pair.friction else 0.0 for pair in scene.contacts}
    return found


class Mujoco:
    """A run of MuJoCo at its defaults, or as the file says, in steps of `step`; with `tied` its contacts are
    as stiff as the step permits."""

    def __init__(self, task: Task, step: float = PEER_STEP, tied: bool = False) -> None:
        import mujoco

        self._mujoco, self._task = mujoco, task
        self._model = model = mujoco.MjModel.from_xml_string(task.mjcf or mjcf(task.scene))
        model.opt.timestep = step
        if not task.as_the_file_says:
            model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
            model.opt.solver = mujoco.mjtSolver.mjSOL_NEWTON
            model.opt.iterations = 100
        if tied:
            model.geom_solref[:] = 2 * step, 1.0
        self._data = mujoco.MjData(model)
        for k in np.flatnonzero(model.jnt_limited):  # as imported: a joint starts within its limits
            at = model.jnt_qposadr[k]
            self._data.qpos[at] = np.clip(self._data.qpos[at], *model.jnt_range[k])
        names = {model.body(k).name or f"body{k}": k for k in range(1, model.nbody)}
        self._number = [names.get(body.name, 0) for body in task.scene.bodies]  # 0: the world
        if task.mjcf is None:
            moving = [body for body in task.scene.bodies if body.motion == "dynamic"]
            self._data.qvel.reshape(-1, 6)[:, :3] = [body.velocity for body in moving]
        self.steps = 0

    def go(self, watch: Watch | None) -> None:
        step, total = self._model.opt.timestep, self._task.until
        controls = self._task.controls
        every = WATCHED if controls is None else HELD
        per_look = max(round(every / step), 1)
        for k in range(round(total / step / per_look)):
            if controls is not None:
                self._data.ctrl[:] = controls[k]
            self._mujoco.mj_step(self._model, self._data, per_look)
            self.steps += per_look
            if watch:
                watch()

    def poses(self) -> tuple[Array, Array]:
        self._mujoco.mj_kinematics(self._model, self._data)
        at = np.array(self._data.xpos[self._number])
        return at, np.array(self._data.xmat[self._number]).reshape(-1, 3, 3)

    def contacts(self) -> int:
        return int(self._data.ncon)

    @property
    def t(self) -> float:
        return float(self._data.time)

    @property
    def failure(self) -> str:
        bad = (self._mujoco.mjtWarning.mjWARN_BADQPOS, self._mujoco.mjtWarning.mjWARN_BADQACC)
        return "diverged" if any(self._data.warning[int(kind)].number for kind in bad) else ""


class Bullet:
    """A run of Bullet at its defaults, without its damping. It has no ellipsoids, and takes no files here."""

    def __init__(self, task: Task, step: float = BULLET_STEP) -> None:
        import pybullet

        self._bullet, self._task, self._step = pybullet, task, step
        if task.mjcf or any(shape.kind == "ellipsoid" for body in task.scene.bodies for shape in body.shapes):
            raise NotInProgram
        if not pybullet.isConnected():
            pybullet.connect(pybullet.DIRECT)
        pybullet.resetSimulation()
        pybullet.setGravity(*task.scene.gravity)
        pybullet.setTimeStep(step)
        friction = friction_of(task.scene) ** 0.5  # of a contact: the product of both
        self._number = [self._added(body, friction) for body in task.scene.bodies]
        self.steps = 0

    def _added(self, body: Body, friction: float) -> int:
        bullet, (shape,) = self._bullet, body.shapes
        sizes = [*numbers(shape).values()]
        w, *xyz = body.pose.quaternion
        of_kind: dict[str, Callable[[], tuple[dict[str, Any], float]]] = {
            "plane": lambda: ({"planeNormal": [0, 0, 1]}, 0.0),
            "sphere": lambda: ({"radius": sizes[0]}, 4 / 3 * np.pi * sizes[0] ** 3),
            "capsule": lambda: (
                {"radius": sizes[0], "height": sizes[1]},
                np.pi * sizes[0] ** 2 * (sizes[1] + 4 / 3 * sizes[0]),
            ),
            "box": lambda: ({"halfExtents": [edge / 2 for edge in sizes]}, float(np.prod(sizes))),
        }
        given, volume = of_kind[shape.kind]()
        collision = bullet.createCollisionShape(getattr(bullet, f"GEOM_{shape.kind.upper()}"), **given)
        mass = volume * (body.density or 0.0) if body.motion == "dynamic" else 0.0
        number = bullet.createMultiBody(mass, collision, -1, body.pose.position, [*xyz, w])
        bullet.changeDynamics(
            number, -1, lateralFriction=friction, restitution=0, linearDamping=0, angularDamping=0
        )
        bullet.resetBaseVelocity(number, body.velocity, [0, 0, 0])
        return int(number)

    def go(self, watch: Watch | None) -> None:
        per_look = max(round(WATCHED / self._step), 1)
        for _ in range(round(self._task.until / self._step)):
            self._bullet.stepSimulation()
            self.steps += 1
            if watch and self.steps % per_look == 0:
                watch()

    def poses(self) -> tuple[Array, Array]:
        found = [self._bullet.getBasePositionAndOrientation(number) for number in self._number]
        turned = [rotation_of((w, x, y, z)) for _, (x, y, z, w) in found]
        return np.array([at for at, _ in found]), np.array(turned)

    def contacts(self) -> int:
        return len(self._bullet.getContactPoints())

    @property
    def t(self) -> float:
        return self.steps * self._step

    @property
    def failure(self) -> str:
        return ""


class NotInProgram(Exception):  # noqa: N818 - nothing is wrong
    """A program has no like of the task."""


def programs(library: Library, task: Task, bullet: bool) -> dict[str, Callable[[], Run]]:
    """What makes a run of each program at the settings of the table."""
    found: dict[str, Callable[[], Run]] = {
        "modelgen": partial(Modelgen, task, library, "coarse", {}),
        "MuJoCo": partial(Mujoco, task),
    }
    return found | ({"Bullet": partial(Bullet, task)} if bullet else {})
