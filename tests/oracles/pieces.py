"""Bodies and measures that the oracles share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.errors import SimulationError
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene, Shape
from tests.running import library_of

G = 9.81
TABLE = make.fixed("table", make.plane())


def ball(
    name: str, position: Sequence[float], radius: float = 0.1, mass: float = 1.0, **keys: object
) -> Body:
    """A solid ball."""
    inertia = [0.4 * mass * radius**2] * 3
    return make.dynamic(
        name, make.sphere(radius), mass=mass, inertia=inertia, position=list(position), **keys
    )


def solid(name: str, axes: Sequence[float], mass: float = 1.0, **keys: object) -> Body:
    """A solid ellipsoid."""
    a, b, c = axes
    inertia = [mass / 5 * (b * b + c * c), mass / 5 * (a * a + c * c), mass / 5 * (a * a + b * b)]
    return make.dynamic(name, make.ellipsoid(a, b, c), mass=mass, inertia=inertia, **keys)


def ran(
    bodies: Sequence[Body],
    until: float,
    contact: Sequence[Mapping[str, object]] = (),
    accuracy: Accuracy | None = None,
    samples: int = 20,
    **keys: object,
) -> Trajectory:
    """The run of a scene, tight unless told otherwise. Scenes of one set of kinds share one library."""
    scene = make.scene("oracle", bodies, contact=list(contact), **keys)
    return simulate(
        library_of(scene), until=until, accuracy=accuracy or Accuracy.tight(), samples=samples, estimate=False
    )


def near_start(fixed: Shape, free: Shape, turns: Sequence[Rotation], at: np.ndarray) -> Scene:
    """A fixed body and a free one at `at`, turned, which may touch; without gravity."""
    poses = [{"quaternion": turn.as_quat()[[3, 0, 1, 2]].tolist()} for turn in turns]
    bodies = [
        make.fixed("fixed", fixed, **poses[0]),
        make.dynamic("free", free, mass=1.0, inertia=[1.0] * 3, position=at.tolist(), **poses[1]),
    ]
    return make.scene("starts", bodies, contact=[{"between": ["free", "fixed"]}], gravity=[0.0, 0.0, 0.0])


def is_start_refused(scene: Scene) -> bool:
    try:
        simulate(library_of(scene), until=1e-6, estimate=False)
    except SimulationError:
        return True
    return False


def imbalance(path: Trajectory) -> float:
    """The spread of E - work over the samples, J."""
    return float(np.ptp(path.energy - path.work))


def rotations(path: Trajectory, body: int) -> np.ndarray:
    """(n, 3, 3)."""
    return Rotation.from_quat(np.roll(path.quaternion[:, body].astype(float), -1, axis=-1)).as_matrix()


def times(path: Trajectory, kind: str) -> list[float]:
    """When events of one kind happened, s."""
    return [event.t for event in path.events if event.kind == kind]
