"""The same scene in MuJoCo (extra `peers`): what it can represent of it, and its knobs."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.measure.knobs import Facts, Knob, Settings
from modelgen.measure.motion import Motion
from modelgen.scene.types import Pose, Scene, Shape

if TYPE_CHECKING:
    from modelgen.measure.program import Bench

REPEATS, ENOUGH_S = 3, 0.15
ROUND = ("sphere", "ellipsoid", "capsule", "cylinder", "box")
GEOMS: Mapping[
    str, tuple[tuple[str, ...], tuple[float, ...]]
] = {  # parameters, and what of each MuJoCo takes
    "sphere": (("radius",), (1.0,)),
    "ellipsoid": (("a", "b", "c"), (1.0, 1.0, 1.0)),
    "capsule": (("radius", "length"), (1.0, 0.5)),
    "cylinder": (("radius", "length"), (1.0, 0.5)),
    "box": (("size_x", "size_y", "size_z"), (0.5, 0.5, 0.5)),
}
HARD = "0.9999 0.9999 0.001 0.5 2"  # solimp of a contact that hardly gives


def _steps(facts: Facts) -> list[float]:
    return [2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5]


KNOBS: tuple[Knob, ...] = (
    Knob("integrator", "order 4 or 1", lambda f: ("RK4", "implicitfast", "Euler"), lambda f, s: True),
    Knob("timestep", "s", _steps, lambda f, s: True, ladder=True),
    Knob(
        "contact",
        "hard, its time constant two steps, or as by default",
        lambda f: ("tied", "default"),
        lambda f, s: f.contacts,
    ),
    Knob("solver", "tolerance of its solver", lambda f: (1e-8, 1e-12), lambda f, s: f.contacts),
    Knob("collider", "its convex collider", lambda f: ("native", "libccd"), lambda f, s: f.contacts),
    Knob("ccd", "tolerance of the collider", lambda f: (1e-6, 1e-12), lambda f, s: f.contacts),
)


@dataclass(frozen=True, slots=True)
class MujocoScene:
    """A scene as MuJoCo would have it, with what it cannot represent, or represents otherwise."""

    cannot: list[str]
    differs: list[str]
    version: str
    bench: Bench

    @classmethod
    def of(cls, bench: Bench) -> MujocoScene:
        version = _module().__version__
        scene = bench.subject.scene
        differs = ["its contacts give way: a penetration carries the force"] if scene.contacts else []
        return cls(unlike(scene), differs, version, bench)

    def run(self, settings: Settings) -> tuple[Motion | None, float, str]:
        """The motion, CPU seconds of the least of some runs, and why there is no motion."""
        mujoco, subject = _module(), self.bench.subject
        interval = subject.until / subject.samples
        per_sample = max(1, round(interval / float(settings["timestep"])))
        text = self._text(settings, interval / per_sample)
        model = mujoco.MjModel.from_xml_string(text)
        spent: list[float] = []
        while not spent or (len(spent) < REPEATS and sum(spent) < ENOUGH_S):
            states, seconds = self._states(model, per_sample)
            spent.append(seconds)
        if not np.isfinite(states).all():
            return None, min(spent), "its state became infinite"
        return self._motion(states), min(spent), ""

    def _states(self, model: Any, per_sample: int) -> tuple[np.ndarray[Any, Any], float]:
        """(samples + 1, 13 nb): qpos and qvel of all bodies, and CPU seconds."""
        mujoco, path = _module(), self.bench.reference.path
        data = mujoco.MjData(model)
        for k, body in enumerate(self.bench.reference.bodies.moving):
            rotation = np.zeros(9)
            mujoco.mju_quat2Mat(rotation, path.quaternion[0, body].astype(float))
            data.qpos[7 * k : 7 * k + 7] = [*path.p[0, body], *path.quaternion[0, body]]
            turning = rotation.reshape(3, 3).T @ path.w[0, body].astype(float)
            data.qvel[6 * k : 6 * k + 6] = [*path.v[0, body], *turning]
        states = [np.concatenate([data.qpos, data.qvel])]
        begun = time.thread_time()
        for _ in range(self.bench.subject.samples):
            mujoco.mj_step(model, data, nstep=per_sample)
            states.append(np.concatenate([data.qpos, data.qvel]))
        return np.array(states), time.thread_time() - begun

    def _motion(self, states: np.ndarray[Any, Any]) -> Motion:
        nb = len(self.bench.reference.bodies.moving)
        q = states[:, : 7 * nb].reshape(-1, nb, 7)
        v = states[:, 7 * nb :].reshape(-1, nb, 6)
        t = np.linspace(0.0, self.bench.subject.until, self.bench.subject.samples + 1)
        return Motion(t, q[..., :3], q[..., 3:], v[..., :3], None, None, {})

    def _text(self, settings: Settings, dt: float) -> str:
        """The scene as MJCF."""
        scene, sentence = self.bench.subject.scene, self.bench.plain.manifest.sentence
        tied = settings.get("contact", "tied") == "tied"
        contact = f'solref="{2 * dt!r} 1" solimp="{HARD}"' if tied else ""
        bodies = "".join(
            _body(k, body, entry)
            for k, (body, entry) in enumerate(zip(scene.bodies, sentence["bodies"], strict=True))
        )
        names = {body.name: k for k, body in enumerate(scene.bodies)}
        pairs = "".join(
            f'<pair geom1="{names[a[0]]}/{a[1]}" geom2="{names[b[0]]}/{b[1]}" condim="1" {contact}/>'
            for a, b in (pair.between for pair in scene.contacts)
        )
        return (
            f"<mujoco>{_option(settings, dt, scene)}<worldbody>{bodies}</worldbody>"
            f"<contact>{pairs}</contact></mujoco>"
        )


def _option(settings: Settings, dt: float, scene: Scene) -> str:
    native = "enable" if settings.get("collider", "native") == "native" else "disable"
    return (
        f'<option integrator="{settings["integrator"]}" timestep="{dt!r}" gravity="{_words(scene.gravity)}" '
        f'cone="elliptic" tolerance="{settings.get("solver", 1e-8)}" iterations="200" '
        f'ccd_tolerance="{settings.get("ccd", 1e-6)}" ccd_iterations="200">'
        f'<flag nativeccd="{native}"/></option>'
    )


def _module() -> Any:
    try:
        import mujoco
    except ImportError:
        raise ModelgenError(
            "against", "mujoco is not installed", "", "install it with: pip install 'modelgen[peers]'"
        ) from None
    return mujoco


def _words(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _body(index: int, body: Any, entry: Mapping[str, Any]) -> str:
    """One body as MJCF, its frame at the centre of mass; those that move start where the state puts them."""
    geoms = "".join(_geom(index, shape, entry["com"]) for shape in body.shapes)
    if entry["motion"] == "fixed":
        rotation = np.array(entry["parameters"][3:]).reshape(3, 3).T
        quaternion = np.zeros(4)
        _module().mju_mat2Quat(quaternion, rotation.ravel())
        pose = f'pos="{_words(entry["parameters"][:3])}" quat="{_words(quaternion)}"'
        return f"<body {pose}>{geoms}</body>"
    mass, *inertia = entry["parameters"]
    numbers = {0: [mass] * 3, 1: inertia * 3, 3: inertia, 6: inertia}[len(inertia)]
    full = [*numbers, 0.0, 0.0, 0.0][:6]
    inertial = f'<inertial pos="0 0 0" mass="{mass!r}" fullinertia="{_words(full)}"/>'
    return f"<body><freejoint/>{inertial}{geoms}</body>"


def _geom(index: int, shape: Shape, centre: Iterable[float]) -> str:
    kind, pose = shape.kind, shape.pose
    at = np.array(pose.position) - np.array(list(centre))
    placed = f'name="{index}/{shape.name}" pos="{_words(at)}" quat="{_words(pose.quaternion)}"'
    silent = 'contype="0" conaffinity="0"'  # the listed pairs alone touch
    size = "0 0 1" if kind == "plane" else _words(_size(shape))
    return f'<geom type="{kind}" size="{size}" {placed} {silent}/>'


def _size(shape: Shape) -> list[float]:
    names, shares = GEOMS[shape.kind]
    values = [value for _, value in shape.parameters]
    return [share * value for share, value in zip(shares, values[: len(names)], strict=True)]


def unlike(scene: Scene) -> list[str]:
    """Sentences: what of a scene MuJoCo has no like of, or this export does not write."""
    found = [f"body {body.name!r} is driven along a path" for body in scene.bodies if body.motion == "driven"]
    touching = {partner for pair in scene.contacts for partner in pair.between}
    for body in scene.bodies:
        for shape in body.shapes:
            if (body.name, shape.name) in touching:
                found += _refused(f"shape {body.name}/{shape.name}", shape, body.motion == "fixed")
    found += [
        f"contact {k} has a restitution" for k, pair in enumerate(scene.contacts) if pair.restitution.value
    ]
    found += [f"joint {joint.name!r} is not exported" for joint in scene.joints]
    return [*found, *(["loads are not exported"] if scene.loads else [])]


def _refused(where: str, shape: Shape, fixed: bool) -> list[str]:
    if shape.cavity:
        return [f"{where} is a cavity"]
    if shape.kind == "plane":
        return [] if fixed and shape.pose == Pose() else [f"{where} is a plane that is not fixed as written"]
    if shape.kind not in GEOMS or len(shape.parameters) < len(GEOMS[shape.kind][0]):
        return [f"{where} is a {shape.kind}"]
    return []
