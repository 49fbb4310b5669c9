"""ellipsoid_on_plane in MuJoCo and here, cost at equal error, in one run (extra `peers`).

Run with `python -m tests.benchmarks.against_mujoco`. MuJoCo runs at the settings that serve it best on this
scene: RK4, frictionless contact of dimension 1, solref tied to the step (2 dt), hard solimp, and three
tolerances of its solver, of which the first is its default and the cheapest. Errors are root mean squares
over the samples of 2 s and over the tips of the three semi-axes, against the long-double build.
"""

from __future__ import annotations

from dataclasses import replace
from statistics import median
from time import process_time

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Trajectory
from tests.running import scene_of

SEMI_AXES, MASS, INERTIA = (0.12, 0.09, 0.07), 1.2, (0.00312, 0.004632, 0.0054)
UNTIL, SAMPLES = 2.0, 20
MODEL = """
<mujoco>
  <option integrator="RK4" timestep="{dt}" gravity="0 0 -9.81" cone="elliptic" tolerance="{solver}"/>
  <worldbody>
    <geom type="plane" size="5 5 1" condim="1" friction="0" solref="{tc} 1"
          solimp="0.9999 0.9999 0.001 0.5 2"/>
    <body name="egg" pos="{p}" quat="{e}">
      <freejoint/>
      <inertial pos="0 0 0" mass="{m}" diaginertia="{I}"/>
      <geom type="ellipsoid" size="{s}" condim="1" friction="0" solref="{tc} 1"
            solimp="0.9999 0.9999 0.001 0.5 2"/>
    </body>
  </worldbody>
</mujoco>
"""


def tips(p: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    """The tips of the semi-axes in the world, (n, 3, 3)."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, float), -1, 0)
    axes = [
        [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ]
    columns = np.stack([size * np.stack(axis, -1) for size, axis in zip(SEMI_AXES, axes, strict=True)], 1)
    return np.asarray(p, float)[:, None] + columns


def distance(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.sqrt(((a - b) ** 2).sum(-1).mean()))


def of_path(path: Trajectory) -> np.ndarray:
    return tips(path.p[:, 1], path.quaternion[:, 1])


def mujoco_run(start: Trajectory, dt: float, solver: float) -> tuple[np.ndarray, float]:
    """Tips at the samples, and CPU microseconds per simulated second."""
    import mujoco

    words = lambda values: " ".join(repr(float(v)) for v in values)  # noqa: E731
    text = MODEL.format(
        dt=dt, tc=2 * dt, solver=solver, p=words(start.p[0, 1]), e=words(start.quaternion[0, 1]),
        m=MASS, I=words(INERTIA), s=words(SEMI_AXES),
    )  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, start.quaternion[0, 1].astype(float))
    data.qvel[:3] = start.v[0, 1]
    data.qvel[3:] = rotation.reshape(3, 3).T @ start.w[0, 1]
    steps = round(UNTIL / SAMPLES / dt)
    p, e = [data.qpos[:3].copy()], [data.qpos[3:].copy()]
    begun = process_time()
    for _ in range(SAMPLES):
        mujoco.mj_step(model, data, nstep=steps)
        p.append(data.qpos[:3].copy())
        e.append(data.qpos[3:].copy())
    return tips(np.array(p), np.array(e)), (process_time() - begun) / UNTIL * 1e6


def our_cost(accuracy: Accuracy) -> float:
    """CPU microseconds per simulated second, from runs long enough to time, their fixed cost taken off."""
    library = scene_of("ellipsoid_on_plane")
    times = {}
    for until in (UNTIL, 50 * UNTIL):
        spent = []
        for _ in range(7):
            begun = process_time()
            simulate(library, until=until, accuracy=accuracy, samples=SAMPLES)
            spent.append(process_time() - begun)
        times[until] = median(spent)
    return (times[50 * UNTIL] - times[UNTIL]) / (49 * UNTIL) * 1e6


def main() -> None:
    finest = replace(Accuracy.tight(), tolerance=1e-16, drift=1e-18, residual=1e-16)
    truth_path = simulate(
        scene_of("ellipsoid_on_plane", "support", "long double"),
        until=UNTIL,
        samples=SAMPLES,
        accuracy=finest,
    )
    truth = of_path(truth_path)
    ours = []
    for tolerance in (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12):
        accuracy = Accuracy.of(tolerance)
        path = simulate(scene_of("ellipsoid_on_plane"), until=UNTIL, samples=SAMPLES, accuracy=accuracy)
        ours.append((distance(of_path(path), truth), our_cost(accuracy), tolerance))
        error, price, _ = ours[-1]
        print(f"modelgen tolerance {tolerance:g}: error {error:.1e} m, {price:.0f} us per simulated s")
    for solver in (1e-8, 1e-12, 0.0):
        for dt in (2e-3, 1e-3, 2e-4, 1e-4, 5e-5, 2e-5):
            found, cost = mujoco_run(truth_path, dt, solver)
            error = distance(found, truth)
            equal = min((price for e, price, _ in ours if e <= error), default=float("nan"))
            print(
                f"MuJoCo dt {dt:g} s, solver tolerance {solver:g}: error {error:.1e} m, "
                f"{cost:.0f} us per simulated s, {cost / equal:.0f} times ours"
            )


if __name__ == "__main__":
    main()
