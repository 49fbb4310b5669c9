"""MJCF and URDF as scenes: the motion is MuJoCo's, and what a scene has no like of is said by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelgen import import_scene, read, simulate
from modelgen.errors import ModelgenError
from modelgen.importing.import_formats import Imported
from modelgen.importing.mujoco_shapes import hull_corners
from modelgen.scene.scene_types import Scene
from tests.export.folders import exported
from tests.export.test_robots import ARM, folder_of
from tests.running import SCENES, library_of

mujoco = pytest.importorskip("mujoco")

LINKAGES = """
<mujoco>
  <option timestep="1e-4" integrator="RK4"/>
  <default><geom contype="0" conaffinity="0" density="900"/></default>
  <worldbody>
    <body name="arm" pos="0.1 0 1">
      <joint name="shoulder" axis="0 1 0.2" pos="0 0 0.01" ref="0.3" damping="0.01" stiffness="0.2"
        springref="0.1"/>
      <geom type="capsule" size="0.02" fromto="0 0 0 0.2 0.03 0"/>
      <body name="fore-arm" pos="0.2 0.03 0" euler="10 20 30">
        <joint name="elbow" axis="1 0 0" armature="0.02"/>
        <geom type="box" size="0.1 0.02 0.03" pos="0.1 0 0"/>
        <body name="hand" pos="0.2 0 0" euler="0 30 0"><geom type="sphere" size="0.03"/></body>
      </body>
    </body>
    <body name="bob" pos="0 1 1">
      <joint name="socket" type="ball" pos="0 0 0.2" damping="0.002" armature="0.003"/>
      <geom type="ellipsoid" size="0.05 0.03 0.04" pos="0.02 0 -0.05"/>
    </body>
    <body name="cart" pos="0 2 1">
      <joint name="along" type="slide" axis="1 0 0" stiffness="20" damping="0.1" armature="0.3"/>
      <joint name="tilt" axis="0 1 0" pos="0 0 0.1"/>
      <joint name="swing" axis="1 0 0" pos="0 0 0.1"/>
      <geom type="cylinder" size="0.04 0.1" pos="0 0 -0.1"/>
    </body>
    <body name="stone" pos="1 0 1" gravcomp="0.5">
      <freejoint/>
      <inertial pos="0.01 0.02 0.03" mass="2" fullinertia="0.02 0.03 0.04 0.001 0.002 0.003"/>
      <geom type="sphere" size="0.1"/>
      <site name="tip" pos="0.1 0 0" euler="0 0 40"/>
    </body>
    <body name="flywheel" pos="2 0 1">
      <joint name="axle" axis="0 0 1" armature="0.003"/>
      <geom type="cylinder" size="0.1 0.01"/>
    </body>
    <site name="nail" pos="1 0 2"/>
  </worldbody>
  <tendon>
    <spatial name="cord" stiffness="30" damping="0.2" springlength="0.8">
      <site site="nail"/><site site="tip"/>
    </spatial>
  </tendon>
  <actuator>
    <motor name="push" joint="along" gear="3" ctrlrange="-1 1" ctrllimited="true"/>
    <position name="servo" joint="elbow" kp="0.4" kv="0.02"/>
    <motor name="thrust" site="tip" gear="0.5 0 0.2 0 0.1 0"/>
    <motor name="spin" joint="axle" gear="0.1"/>
  </actuator>
  <sensor>
    <jointpos name="bend" joint="elbow"/><framepos name="nose" objtype="site" objname="tip"/>
    <touch name="felt" site="tip"/>
  </sensor>
  <keyframe>
    <key name="start" qpos="0.5 -0.4  0.98 0.1 0.1 0.1  0.05 0.3 -0.2  1.1 0.1 1.2 0.9 0.3 0.2 0.1  0.2"
      qvel="0.3 -1  0.5 1 2  0.4 -1 1  0.1 0.2 0.3 1 2 -1  4" ctrl="0.5 0.2 0.7 0.4"/>
  </keyframe>
</mujoco>
"""
UNTIL = 0.4  # s


def of(text: str, tmp_path: Path, end: str = "xml", **choices: Any) -> Imported:
    path = tmp_path / f"model.{end}"
    path.write_text(text)
    return import_scene(path, **choices)


def run_of(scene: Scene, until: float) -> Any:
    return simulate(library_of(scene), until=until, samples=4, accuracy="tight", estimate=False)


def test_motions_of_linkages_are_those_of_mujoco(tmp_path: Path) -> None:
    """Links between three joints have 1e-6 of the mass of their body: motions differ by that order."""
    found = of(LINKAGES, tmp_path)
    path = run_of(found.scene, UNTIL)
    model = mujoco.MjModel.from_xml_string(LINKAGES)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, nstep=round(UNTIL / model.opt.timestep))
    mujoco.mj_kinematics(model, data)
    for name in ("arm", "bob", "cart", "stone", "flywheel"):
        k = path.body_names.index(name)
        bound = 2e-6 if name == "cart" else 1e-8
        assert path.p[-1, k] == pytest.approx(data.xipos[model.body(name).id], abs=bound), name
    sensors = dict(zip(path.sensor_names, path.sensors[-1].T, strict=False))
    assert sensors["bend"] == pytest.approx(data.qpos[1], abs=1e-8)
    assert [sensors[f"nose_{axis}"] for axis in "xyz"] == pytest.approx(data.site("tip").xpos, abs=1e-8)
    assert any("1e-06 of its mass" in sentence for sentence in found.approximated)
    assert found.left_out == ("sensor 'felt', a touch",)


def test_an_exported_scene_comes_back(tmp_path: Path) -> None:
    """Masses, places, velocities, friction; the run is that of the scene within rounding of its numbers."""
    name = "sphere_slide_to_roll"
    again = import_scene(exported(name, "mjcf", tmp_path) / f"{name}.xml").scene
    first, second = read(SCENES / f"{name}.toml"), again
    assert {body.name: len(body.shapes) for body in first.bodies} == {
        body.name: len(body.shapes) for body in second.bodies
    }
    (one,), (other,) = first.contacts, second.contacts
    assert other.friction.kinetic == pytest.approx(one.friction.kinetic)
    runs = [run_of(scene, 0.3) for scene in (first, second)]
    order = [runs[1].body_names.index(each) for each in runs[0].body_names]
    assert np.abs(runs[0].p[-1] - runs[1].p[-1][order]).max() < 1e-9
    assert np.abs(runs[0].w[-1] - runs[1].w[-1][order]).max() < 1e-8


def test_an_exported_urdf_comes_back(tmp_path: Path) -> None:
    found = import_scene(folder_of(ARM, "urdf", tmp_path) / "arm.urdf").scene
    (joint,) = found.joints
    arm = next(body for body in found.bodies if body.name == "arm")
    assert (joint.name, joint.kind) == ("shoulder", "revolute")
    assert arm.mass == pytest.approx(1.0)
    assert np.sort(np.linalg.eigvalsh(np.array(arm.inertia))) == pytest.approx([0.01, 0.02, 0.03])


def test_the_first_link_of_a_urdf_rests_or_floats(tmp_path: Path) -> None:
    link = (
        '<link name="{}"><inertial><mass value="2"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    joint = (
        '<joint name="j" type="continuous"><parent link="base"/><child link="arm"/>'
        '<axis xyz="1 0 0"/></joint>'
    )
    text = f'<robot name="r">{link.format("base")}{link.format("arm")}{joint}</robot>'
    rests, floats = of(text, tmp_path, "urdf"), of(text, tmp_path, "urdf", floating=True)
    assert [body.name for body in rests.scene.bodies if body.motion == "dynamic"] == ["arm"]
    assert (
        "link 'base', to which the others are joined, rests (--floating lets it move)" in rests.approximated
    )
    assert [body.name for body in floats.scene.bodies if body.motion == "dynamic"] == ["base", "arm"]
    assert [each.between for each in floats.scene.joints] == [("base", "arm")]


TOUCHING = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1" friction="0.4" condim="3"/>
    <body name="a" pos="0 0 0.199"><freejoint/>
      <geom name="ga" size="0.2" friction="0.7 0.01 0.001" condim="6"/>
      <geom name="seen" size="0.3" contype="0" conaffinity="0"/>
      <body name="b" pos="0.5 0 0"><joint axis="0 0 1"/><geom name="gb" size="0.1" condim="1"/>
        <body name="c" pos="0.3 0 0"><joint axis="0 0 1"/>
          <geom name="gc" size="0.1" condim="1" solref="0.02 0.2"/></body>
      </body>
    </body>
    <body name="d" pos="0 2 1"><freejoint/><geom name="gd" size="0.1" contype="2" conaffinity="2"/></body>
    <body name="e" pos="0 3 1"><freejoint/><geom name="ge" size="0.1" condim="1"/></body>
    <body name="f" pos="0 4 1"><freejoint/><geom name="gf" size="0.1" condim="1"/></body>
  </worldbody>
  <contact>
    <exclude body1="e" body2="a"/>
    <pair geom1="gd" geom2="floor" condim="3" friction="0.9 0.9 0 0 0"/>
  </contact>
</mujoco>
"""


def test_contacts_are_those_that_mujoco_lets_touch(tmp_path: Path) -> None:
    found = of(TOUCHING, tmp_path)
    pairs = {frozenset(shape for _, shape in pair.between): pair for pair in found.scene.contacts}
    wanted = {"floor ga", "floor gb", "floor gc", "floor gd", "floor ge", "floor gf", "ga gc", "ga gf"}
    wanted |= {f"{x} {y}" for x in ("gb", "gc") for y in ("ge", "gf")} | {"ge gf"}
    assert set(pairs) == {frozenset(pair.split()) for pair in wanted}
    roll = pairs[frozenset(("floor", "ga"))]
    assert (roll.friction.kinetic[0], roll.spinning_resistance, roll.rolling_resistance) == (0.7, 0.01, 0.001)
    assert pairs[frozenset(("floor", "gd"))].friction.kinetic[0] == 0.9
    assert pairs[frozenset(("ge", "gf"))].friction is None
    given_back = np.exp(-np.pi * 0.6 / np.sqrt(1 - 0.6**2))  # the mean of the damping ratios 1 and 0.2
    assert pairs[frozenset(("gc", "ge"))].restitution.value == pytest.approx(given_back)
    raised = next(body for body in found.scene.bodies if body.name == "a")
    assert 0.2 < raised.pose.position[2] < 0.2 + 1e-4
    assert any("out of what it stands in" in sentence for sentence in found.approximated)


BODY = '<body name="x"><freejoint/><geom size="0.1"/>{}</body>'
REFUSED = [
    ('<option density="1"/>', "", "a medium of density 1", "fluid"),
    (
        '<tendon><fixed name="f" stiffness="1"><joint joint="j" coef="1"/></fixed></tendon>',
        '<body><joint name="j"/><geom size="1"/></body>', "tendon 'f' is not straight", "tendons",
    ),
    (
        '<actuator><muscle name="m" joint="j" lengthrange="0 1"/></actuator>',
        '<body><joint name="j"/><geom size="1"/></body>', "actuator 'm' has activation", "actuators",
    ),
    (
        '<equality><joint name="e" joint1="j" joint2="k"/></equality>',
        '<body><joint name="j"/><geom size="1"/><body><joint name="k"/><geom size="1"/></body></body>',
        "equality 'e' is neither", "constraints",
    ),
    (
        '<asset><mesh name="m" file="away.stl"/></asset>',
        '<body><joint/><geom size="1"/><geom name="g" type="mesh" mesh="m"/></body>',
        "mesh 'away.stl' is not there", "meshes",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("part", "body", "told", "name"), REFUSED)
def test_what_a_scene_has_no_like_of_is_refused_by_name(
    part: str, body: str, told: str, name: str, tmp_path: Path
) -> None:
    text = f"<mujoco>{part}<worldbody>{body or BODY.format('')}</worldbody></mujoco>"
    with pytest.raises(ModelgenError, match=f"{told}.*--without {name}"):
        of(text, tmp_path)
    assert any(told in sentence for sentence in of(text, tmp_path, without=[name]).left_out)


@pytest.mark.parametrize(
    ("text", "choices", "told"),
    [
        ("<mujoco><worldbody><body/></worldbody>", {}, "a file of no known format|MuJoCo refuses"),
        ("<mujoco><worldbody><body><freejoint/></body></worldbody></mujoco>", {}, "MuJoCo refuses it: mass"),
        ("<sdf/>", {}, "SDF, for which there is no kept parser.*convert it to URDF or MJCF"),
        ("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>", {}, "nothing in it moves"),
        (LINKAGES, {"key": "end"}, "no such keyframe; keyframes: start"),
        (LINKAGES, {"without": ["fluids"]}, "did you mean 'fluid'"),
        (LINKAGES, {"kind": "revolution"}, "--as: it with a file of mjcf; it goes with profile"),
        (LINKAGES, {"format": "mjfc"}, "did you mean 'mjcf'"),
    ],
)
def test_mistakes_are_told(text: str, choices: dict[str, Any], told: str, tmp_path: Path) -> None:
    with pytest.raises(ModelgenError, match=told):
        of(text, tmp_path, **choices)


def test_a_hull_of_fewer_corners_tells_what_it_cuts_off() -> None:
    """Against the distance by another route: the least over many directions of how far a point is beyond."""
    rng = np.random.default_rng(1)
    points = rng.normal(size=(80, 3))
    points *= [1.0, 2.0, 0.5] / np.linalg.norm(points, axis=1, keepdims=True)
    corners, missed = hull_corners(points, 24)
    assert len(corners) == 24
    directions = rng.normal(size=(5000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    beyond = ((points @ directions.T) - (corners @ directions.T).max(axis=0)).max()
    assert 0.95 * missed < beyond < missed * (1 + 1e-6)
    assert hull_corners(points, 500)[1] == 0.0


@pytest.mark.slow
def test_mujoco_comes_to_the_run_of_an_imported_contact_as_its_step_shrinks(tmp_path: Path) -> None:
    """Contacts of the file give way with a time constant of two steps; those of the scene are rigid."""
    name, until, errors = "ellipsoid_on_plane", 0.2, []
    for step in (1e-3, 1e-4, 1e-5):
        file = exported(name, "mjcf", tmp_path, step=step) / f"{name}.xml"
        path = run_of(import_scene(file).scene, until)
        model = mujoco.MjModel.from_xml_path(str(file))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        mujoco.mj_step(model, data, nstep=round(until / step))
        k = next(k for k, body in enumerate(path.body_names) if model.body(body).dofnum[0])
        errors.append(float(np.abs(data.xipos[model.body(path.body_names[k]).id] - path.p[-1, k]).max()))
    assert errors[-1] < errors[0] / 30
    assert errors[-1] < 1e-5


def test_a_scene_larger_than_a_scene_file_may_be_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("modelgen.importing.import_formats.LARGEST", 200)
    with pytest.raises(ModelgenError, match=r"a scene of \d+ bytes; a scene file has at most 200"):
        of(TOUCHING, tmp_path)
