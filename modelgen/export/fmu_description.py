"""What an FMU says of itself: its variables, and `modelDescription.xml` of FMI 2.0 and 3.0."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from modelgen import __version__
from modelgen.notation import component_names

UNITS: Mapping[str, Mapping[str, str]] = {"s": {"s": "1"}, "m": {"m": "1"}, "m/s": {"m": "1", "s": "-1"},
                                          "rad/s": {"rad": "1", "s": "-1"}}  # fmt: skip
STATES = {  # components of q, then of u, of a body by its motion, with their units
    "point": (
        [("position_x", "m"), ("position_y", "m"), ("position_z", "m")],
        [("velocity_x", "m/s"), ("velocity_y", "m/s"), ("velocity_z", "m/s")],
    ),
    "free": (
        [("position_x", "m"), ("position_y", "m"), ("position_z", "m")]
        + [(f"quaternion_{axis}", "") for axis in "wxyz"],
        [("velocity_x", "m/s"), ("velocity_y", "m/s"), ("velocity_z", "m/s")]
        + [(f"angular_velocity_{axis}", "rad/s") for axis in "xyz"],
    ),
}
TURNING = "; angular velocity in the axes of the body"


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of an FMU; its number is its place in the list."""

    name: str
    causality: str  # independent, input, output or local
    variability: str
    description: str = ""
    unit: str = ""
    start: float | None = None
    least: float | None = None
    largest: float | None = None


DOUBTS = Variable(
    "run.doubts",
    "output",
    "discrete",
    "reasons not to trust the run so far, bits MG_DOUBT_.. of modelgen.h; 0: none that its figures show",
)


@dataclass(frozen=True, slots=True)
class Variables:
    """The variables of an FMU in the order of their numbers: time, inputs, sensors, states, constants, and
    the doubts of its run."""

    inputs: tuple[Variable, ...]
    sensors: tuple[Variable, ...]
    states: tuple[Variable, ...]
    constants: tuple[Variable, ...]

    @property
    def all(self) -> tuple[Variable, ...]:
        time = Variable("time", "independent", "continuous", unit="s")
        return (time, *self.inputs, *self.sensors, *self.states, *self.constants, DOUBTS)


def variables_of(instance: Mapping[str, Any], states: bool) -> Variables:
    """The variables of a scene; `states`: with those of bodies that forces move."""
    sensors = component_names(instance["sensors"]["names"])
    return Variables(
        tuple(_input(each) for each in instance["inputs"]),
        tuple(Variable(name, "output", "continuous", "sensor") for name in sensors),
        tuple(_states(instance)) if states else (),
        tuple(
            Variable(each["name"], "local", "constant", "parameter of the scene, fixed at export",
                     start=float(each["value"]))
            for each in instance.get("parameters", ())
        ),
    )  # fmt: skip


def _input(each: Mapping[str, Any]) -> Variable:
    unit = f", {each['unit']}" if each["unit"] else ""
    if each["hold"] == "linear":
        told = f"rate of an input{unit}, per s"
        return Variable(f"{each['name']}.rate", "input", "continuous", told, start=0.0)
    bounds = {"least": each["minimum"], "largest": each["maximum"]}
    return Variable(
        each["name"], "input", "continuous", f"input{unit}", start=float(each["default"]), **bounds
    )


def _states(instance: Mapping[str, Any]) -> list[Variable]:
    """q of all bodies, then u of all bodies, in their order in the state."""
    moved = [body for body in instance["bodies"] if body["motion"] in STATES]
    return [
        Variable(f"{body['name']}.{name}", "output", "continuous", f"state of a body{TURNING}", unit)
        for part in (0, 1)
        for body in sorted(moved, key=lambda each: each["q" if part == 0 else "u"])
        for name, unit in STATES[body["motion"]][part]
    ]


def identifier(name: str) -> str:
    """The name of a scene as C has names."""
    word = re.sub(r"\W", "_", name)
    return f"scene_{word}" if word[:1].isdigit() else word


def description_2(
    name: str, token: str, variables: Variables, run: Mapping[str, Any], sources: tuple[str, ...]
) -> str:
    """The modelDescription.xml of FMI 2.0."""
    root = _root("2.0", name, {"guid": token, "numberOfEventIndicators": "0"})
    simulated = ElementTree.SubElement(
        root, "CoSimulation", modelIdentifier=identifier(name), canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true", canSerializeFMUstate="true", canNotUseMemoryManagementFunctions="true",
    )  # fmt: skip
    files = ElementTree.SubElement(simulated, "SourceFiles")
    for source in sources:
        ElementTree.SubElement(files, "File", name=source)
    _units(root)
    _experiment(root, run)
    listed = ElementTree.SubElement(root, "ModelVariables")
    for number, each in enumerate(variables.all):
        scalar = ElementTree.SubElement(listed, "ScalarVariable", _named(each, number))
        ElementTree.SubElement(scalar, "Real", _numbers(each))
    structure = ElementTree.SubElement(root, "ModelStructure")
    outputs = [k for k, each in enumerate(variables.all, start=1) if each.causality == "output"]
    for group in ("Outputs", "InitialUnknowns") if outputs else ():
        part = ElementTree.SubElement(structure, group)
        for k in outputs:
            ElementTree.SubElement(part, "Unknown", index=str(k))
    return _text(root)


def description_3(name: str, token: str, variables: Variables, run: Mapping[str, Any]) -> str:
    """The modelDescription.xml of FMI 3.0."""
    root = _root("3.0", name, {"instantiationToken": token})
    ElementTree.SubElement(
        root, "CoSimulation", modelIdentifier=identifier(name), canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUState="true", canSerializeFMUState="true",
    )  # fmt: skip
    _units(root)
    _experiment(root, run)
    listed = ElementTree.SubElement(root, "ModelVariables")
    for number, each in enumerate(variables.all):
        ElementTree.SubElement(listed, "Float64", {**_named(each, number), **_numbers(each)})
    structure = ElementTree.SubElement(root, "ModelStructure")
    for group in ("Output", "InitialUnknown"):
        for number, each in enumerate(variables.all):
            if each.causality == "output":
                ElementTree.SubElement(structure, group, valueReference=str(number))
    return _text(root)


def build_description(name: str, sources: tuple[str, ...], defines: tuple[str, ...]) -> str:
    """The sources/buildDescription.xml of FMI 3.0."""
    root = ElementTree.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=identifier(name))
    files = ElementTree.SubElement(configuration, "SourceFileSet", language="C99")
    for source in sources:
        ElementTree.SubElement(files, "SourceFile", name=source)
    for define in defines:
        ElementTree.SubElement(files, "PreprocessorDefinition", name=define.removeprefix("-D"))
    return _text(root)


def _root(version: str, name: str, more: Mapping[str, str]) -> ElementTree.Element:
    told = {"fmiVersion": version, "modelName": name, **more}
    told |= {"generationTool": f"modelgen {__version__}", "variableNamingConvention": "flat"}
    return ElementTree.Element("fmiModelDescription", told)


def _units(root: ElementTree.Element) -> None:
    units = ElementTree.SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        ElementTree.SubElement(ElementTree.SubElement(units, "Unit", name=name), "BaseUnit", dict(exponents))


def _experiment(root: ElementTree.Element, run: Mapping[str, Any]) -> None:
    step = run["until"] / (run.get("samples") or 100)
    ElementTree.SubElement(
        root, "DefaultExperiment", startTime="0.0", stopTime=repr(float(run["until"])), stepSize=repr(step)
    )


def _named(each: Variable, number: int) -> dict[str, str]:
    told = {"name": each.name, "valueReference": str(number), "causality": each.causality}
    told |= {"variability": each.variability}
    if each.causality == "output":
        told["initial"] = "calculated"
    if each.variability == "constant":
        told["initial"] = "exact"
    return told | ({"description": each.description} if each.description else {})


def _numbers(each: Variable) -> dict[str, str]:
    told = {"unit": each.unit, "min": each.least, "max": each.largest, "start": each.start}
    known = {key: value for key, value in told.items() if value not in (None, "")}
    return {key: repr(v) if isinstance(v, float) else str(v) for key, v in known.items()}


def _text(root: ElementTree.Element) -> str:
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"
