"""The rolling ellipsoid in MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from time import process_time

import numpy as np

from modelgen.benchmark.peers.mjcf import words
from tests.benchmarks.tracks import AXES, INERTIA, MASS, TIMES, Track, start

MODEL = """
<mujoco>
  <option integrator="{integrator}" timestep="{dt}" cone="{cone}" gravity="0 0 -9.81"/>
  <worldbody>
    <geom type="plane" size="5 5 1" friction="1" solref="{reference} 1"/>
    <body pos="{p}" quat="{q}">
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia}"/>
      <geom type="ellipsoid" size="{axes}" friction="1" solref="{reference} 1"/>
    </body>
  </worldbody>
</mujoco>
"""
SOFT = 0.02  # MuJoCo's default time constant of contacts, s


def run(dt: float, integrator: str, cone: str, reference: float) -> Track:
    import mujoco

    begin = start()
    text = MODEL.format(
        integrator=integrator, dt=dt, cone=cone, reference=reference, p=words(begin.p),
        q=words(begin.quaternion), mass=float(MASS), inertia=words(INERTIA), axes=words(AXES),
    )  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qvel[:] = [*begin.v, *begin.w_body]
    steps = round(TIMES[1] / dt)
    places, speeds = [data.qpos.copy()], [data.qvel.copy()]
    begun = process_time()
    for _ in TIMES[1:]:
        mujoco.mj_step(model, data, nstep=steps)
        places.append(data.qpos.copy())
        speeds.append(data.qvel.copy())
    cost = (process_time() - begun) / TIMES[-1] * 1e6
    place, speed = np.array(places), np.array(speeds)
    track = Track.of_quaternions(place[:, :3], place[:, 3:], speed[:, :3], speed[:, 3:], cost)
    return Track(track.p, track.R, track.v, np.einsum("nij,nj->ni", track.R, track.w), cost)


def runs() -> Iterator[tuple[str, Callable[[], Track]]]:
    yield "MuJoCo default, dt 2 ms", lambda: run(2e-3, "Euler", "pyramidal", SOFT)
    yield "MuJoCo default contact, RK4, elliptic, dt 2 ms", lambda: run(2e-3, "RK4", "elliptic", SOFT)
    for dt in (2e-3, 1e-3, 1e-4, 1e-5):
        yield (
            f"MuJoCo implicitfast, solref 2 dt, dt {dt * 1e3:g} ms",
            partial(run, dt, "implicitfast", "pyramidal", 2 * dt),
        )
