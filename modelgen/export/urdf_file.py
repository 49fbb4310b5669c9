"""`--to urdf`: bodies, shapes and joints of a scene as URDF, which has no contacts, loads or velocities."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import atan2, hypot
from xml.etree import ElementTree

import numpy as np

from modelgen.benchmark.peers.scene_description import Setup, Solid, numbers, unused_name
from modelgen.errors import ModelgenError, with_article
from modelgen.rotations import rotation_of
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Body, Joint, Pose, Scene, Shape

SHAPES = ("sphere", "box", "cylinder")
JOINTS: Mapping[str, str] = {"revolute": "continuous", "prismatic": "prismatic", "weld": "fixed"}
REMEDY = "export --to c, fmu or mjcf"
WORLD = "world"  # the root link, which MuJoCo takes for its world
BOUNDLESS = "1e9"  # of limits that a joint has not, m, rad, N, N m, m/s or rad/s: URDF asks for each
FLAT = 1e-12  # cosine of a pitch at which roll and yaw turn about one axis, so that all is yaw


@dataclass(frozen=True, slots=True)
class Held:
    """A body on the joint that holds it, the parent being nearer to the root."""

    body: str
    joint: Joint
    parent: str  # name of a body
    frames: tuple[Pose, Pose]  # in the axes of the parent and of the body, as written
    axis: str  # of the coordinate, in these frames


def check_urdf(scene: Scene) -> None:
    """Raises ModelgenError that names what of a scene URDF has no like of."""
    refused = [*_unlike(scene)]
    if refused:
        raise ModelgenError(scene.source, "; ".join(refused), "URDF has no like of it", REMEDY)


def urdf_files(setup: Setup) -> dict[str, str]:
    """`NAME.urdf` of a scene that `check_urdf` lets pass."""
    scene = setup.scene
    held, links = _tree(scene), _links(scene)
    root = ElementTree.Element("robot", name=scene.name)
    root.append(ElementTree.Comment(_told(scene, links)))
    ElementTree.SubElement(root, "link", name=WORLD)
    names = {joint.name for joint in scene.joints}
    for solid, body in zip(setup.solids, scene.bodies, strict=True):
        name, on = links[body.name], held.get(body.name)
        if name == WORLD:
            continue
        root.append(_link(name, solid, _frame(on)))
        free = unused_name(f"{WORLD}_{name}", names)
        names.add(free)
        root.append(_joint(on, held, links) if on else _free(free, name, body))
    ElementTree.indent(root)
    return {f"{scene.name}.urdf": ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"}


def _tree(scene: Scene) -> dict[str, Held]:
    """What holds each body, by its name: from the fixed bodies on, whichever body a joint names first."""
    later = {joint.between[1] for joint in scene.joints}
    roots = sorted(scene.bodies, key=lambda body: (body.motion != "fixed", body.name in later))
    reached = {body.name for body in roots if body.motion == "fixed"}
    held: dict[str, Held] = {}
    for root in roots:
        if root.name in held:
            continue
        reached.add(root.name)
        waiting = deque([root.name])
        while waiting:
            for each in _held_on(waiting.popleft(), scene.joints):
                if each.body not in reached:
                    reached.add(each.body)
                    waiting.append(each.body)
                    held[each.body] = each
    return held


def _held_on(parent: str, joints: Iterable[Joint]) -> Iterator[Held]:
    for joint in joints:
        first, second = joint.between
        if first == parent:
            yield Held(second, joint, parent, joint.frames, "0 0 1")
        elif second == parent:
            yield Held(first, joint, parent, joint.frames[::-1], "0 0 -1")


def _links(scene: Scene) -> dict[str, str]:
    """The link of each body, by its name: the root for a body that is called so, rests in the origin, and has
    no shapes."""
    links = {body.name: body.name for body in scene.bodies}
    own = next((body for body in scene.bodies if body.name == WORLD), None)
    if own and (own.motion != "fixed" or own.shapes or own.pose != Pose()):
        links[WORLD] = unused_name(WORLD, links)
    return links


def _unlike(scene: Scene) -> Iterator[str]:
    for body in scene.bodies:
        if body.motion == "driven":
            yield f"body {body.name!r} is driven along a path"
        for shape in body.shapes:
            if shape.cavity:
                yield f"shape {body.name}/{shape.name} is a cavity"
            elif shape.kind not in SHAPES:
                yield f"shape {body.name}/{shape.name} is {with_article(shape.kind)}"
    used = {each.joint.name for each in _tree(scene).values()}
    for joint in scene.joints:
        if joint.kind not in JOINTS:
            yield f"joint {joint.name!r} is {joint.kind}"
        if joint.motion is not None or joint.is_sprung:
            yield f"joint {joint.name!r} has a prescribed motion, a spring or a damper"
        if joint.armature:
            yield f"joint {joint.name!r} has armature"
        if joint.name not in used:
            yield f"joint {joint.name!r} closes a loop"


def left_out(scene: Scene) -> list[str]:
    """Phrases: what of a scene that `check_urdf` lets pass URDF has not."""
    present = {
        "which bodies touch, and how": scene.contacts,
        "loads": scene.loads,
        "sensors": scene.sensors,
        "inputs and actuators": (*scene.inputs, *scene.actuators),
        f"gravity {' '.join(map(str, scene.gravity))}": any(scene.gravity),
        "velocities at the start": any(
            any((*body.velocity, *body.angular_velocity)) for body in scene.bodies
        ),
        "restitution at limits of joints": any(joint.restitution for joint in scene.joints),
    }
    return [what for what, found in present.items() if found]


def _told(scene: Scene, links: Mapping[str, str]) -> str:
    """The comment at the beginning of the file."""
    lines = [
        f"{scene.name}, exported by modelgen.",
        "The frame of a link is that of its joint; coordinates are zero where the frames coincide.",
        *(f"Left out: {each}." for each in left_out(scene)),
        *(f"Body {name} is link {link}." for name, link in links.items() if link != name),
    ]
    return " " + "\n     ".join(lines) + " "


def _frame(on: Held | None) -> Pose:
    """The frame of a link in the axes of its body as written: that of its joint."""
    return on.frames[1] if on else Pose()


def _inverse(pose: Pose) -> Pose:
    w, x, y, z = pose.quaternion
    turned = rotation_of(pose.quaternion).T @ np.array(pose.position)
    return Pose((-float(turned[0]), -float(turned[1]), -float(turned[2])), (w, -x, -y, -z))


def _link(name: str, solid: Solid, frame: Pose) -> ElementTree.Element:
    link = ElementTree.Element("link", name=name)
    inner = _inverse(frame)
    if not solid.fixed:
        inertial = ElementTree.SubElement(link, "inertial")
        x, y, z = (float(each) for each in solid.centre)
        inertial.append(_origin(compose(inner, Pose((x, y, z)))))
        ElementTree.SubElement(inertial, "mass", value=repr(solid.mass))
        pairs = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        values = {name: repr(float(solid.inertia[at])) for name, at in pairs.items()}
        ElementTree.SubElement(inertial, "inertia", values)
    for shape in solid.shapes:
        for role in ("visual", "collision"):
            part = ElementTree.SubElement(link, role, name=f"{shape.name}")
            part.append(_origin(compose(inner, shape.pose)))
            geometry = ElementTree.SubElement(part, "geometry")
            ElementTree.SubElement(geometry, shape.kind, _sizes(shape))
    return link


def _sizes(shape: Shape) -> dict[str, str]:
    values = numbers(shape)
    if shape.kind == "box":
        return {"size": " ".join(repr(values[axis]) for axis in "xyz")}
    names = ("radius", "length") if shape.kind == "cylinder" else ("radius",)
    return {name: repr(values[name]) for name in names}


def _joint(on: Held, held: Mapping[str, Held], links: Mapping[str, str]) -> ElementTree.Element:
    joint = on.joint
    limited = joint.limits != (None, None)
    kind = "revolute" if joint.kind == "revolute" and limited else JOINTS[joint.kind]
    element = ElementTree.Element("joint", name=joint.name, type=kind)
    element.append(_origin(compose(_inverse(_frame(held.get(on.parent))), on.frames[0])))
    ElementTree.SubElement(element, "parent", link=links[on.parent])
    ElementTree.SubElement(element, "child", link=links[on.body])
    if kind != "fixed":
        ElementTree.SubElement(element, "axis", xyz=on.axis)
    if kind in ("revolute", "prismatic"):
        least, largest = joint.limits
        bounds = {
            "lower": f"-{BOUNDLESS}" if least is None else repr(float(least)),
            "upper": BOUNDLESS if largest is None else repr(float(largest)),
        }
        ElementTree.SubElement(element, "limit", {"effort": BOUNDLESS, "velocity": BOUNDLESS, **bounds})
    return element


def _free(name: str, link: str, body: Body) -> ElementTree.Element:
    """The joint of a body that no other holds, in the world."""
    kind = "fixed" if body.motion == "fixed" else "floating"
    element = ElementTree.Element("joint", name=name, type=kind)
    element.append(_origin(body.pose))
    ElementTree.SubElement(element, "parent", link=WORLD)
    ElementTree.SubElement(element, "child", link=link)
    return element


def _origin(pose: Pose) -> ElementTree.Element:
    xyz = " ".join(repr(float(each)) for each in pose.position)
    return ElementTree.Element("origin", xyz=xyz, rpy=" ".join(repr(each) for each in rpy_of(pose)))


def rpy_of(pose: Pose) -> tuple[float, float, float]:
    """Roll, pitch and yaw, rad, with R = Rz(yaw) Ry(pitch) Rx(roll)."""
    R = rotation_of(pose.quaternion)
    level = hypot(R[0, 0], R[1, 0])
    pitch = atan2(-R[2, 0], level)
    if level > FLAT:
        return atan2(R[2, 1], R[2, 2]), pitch, atan2(R[1, 0], R[0, 0])
    return 0.0, pitch, atan2(-R[0, 1], R[1, 1])
