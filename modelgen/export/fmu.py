"""`--to fmu`: a scene as two FMUs for co-simulation, of FMI 2.0 and of FMI 3.0, with their sources."""

from __future__ import annotations

import hashlib
import io
import platform
import sys
import zipfile
from collections.abc import Mapping

from modelgen.codegen.amalgamation import SOURCE
from modelgen.codegen.compiler import find_compiler, portable_flags
from modelgen.codegen.core_cache import runtime_object
from modelgen.codegen.emit import Package
from modelgen.codegen.library import REAL_FLAGS, Library
from modelgen.errors import ModelgenError
from modelgen.export.c_folder import program_files
from modelgen.export.fmu_description import (
    Variables,
    build_description,
    description_2,
    description_3,
    identifier,
    variables_of,
)
from modelgen.export.scene_header_and_tables import source
from modelgen.export.shared_library import shared_library
from modelgen.runtime.core_session import Session
from modelgen.runtime.settings import accuracy_of

ENDINGS = {"darwin": ".dylib"}  # of libraries, where they are not .so
DATE = (1980, 1, 1, 0, 0, 0)  # of all files in the archives, so that equal scenes give equal bytes

NUMBERS = """/* Numbers of the variables of the FMU, in the order of modelDescription.xml. */
#define FMU_TOKEN "{token}"
#define FMU_TIME 0u
#define FMU_FIRST_INPUT 1u
#define FMU_FIRST_OUTPUT {sensors}u
#define FMU_FIRST_STATE {states}u
#define FMU_FIRST_CONSTANT {constants}u
#define FMU_DOUBTS {end}u

static const double fmu_constants[] = {{{values}}};
"""


def fmu_files(library: Library, package: Package, states: bool) -> dict[str, bytes]:
    """The two archives by name: `NAME.fmi2.fmu` and `NAME.fmi3.fmu`.

    Raises ModelgenError where the scene shows nothing and `states` does not either, or a name comes twice.
    """
    instance = library.manifest.instance
    variables = variables_of(instance, states)
    _check(variables, instance["source"])
    texts = program_files(Session(library, accuracy_of(instance, None, {})), package)
    token = "{" + hashlib.sha256(repr((sorted(texts.items()), variables)).encode()).hexdigest()[:32] + "}"
    texts |= {"fmu_model.h": _numbers(variables, token), "fmu.h": source("fmu.h"), "fmu.c": source("fmu.c")}
    return {
        f"{instance['name']}.fmi{version}.fmu": _archive(version, library, texts, variables, token)
        for version in (2, 3)
    }


def _check(variables: Variables, where: str) -> None:
    if not variables.sensors and not variables.states:
        found = "it has no sensors: the FMU would show nothing"
        raise ModelgenError(where, found, "", "add [[sensor]] tables, or export with --states")
    names = [each.name for each in variables.all]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        found = f"two variables of the FMU are named {twice!r}"
        raise ModelgenError(where, found, "", "rename the sensor, input or parameter")


def _numbers(variables: Variables, token: str) -> str:
    sensors = 1 + len(variables.inputs)
    states = sensors + len(variables.sensors)
    constants = states + len(variables.states)
    values = ", ".join([*(float(each.start or 0.0).hex() for each in variables.constants), "0"])
    end = constants + len(variables.constants)
    return NUMBERS.format(
        token=token, sensors=sensors, states=states, constants=constants, end=end, values=values
    )


def _archive(
    version: int, library: Library, texts: Mapping[str, str], variables: Variables, token: str
) -> bytes:
    """The zip file of one FMU."""
    instance = library.manifest.instance
    name, run, defines = instance["name"], instance["run"], REAL_FLAGS[library.real]
    interface = f"fmi{version}.c"
    units = ("scene.c", SOURCE, "fmu.c", interface)
    sources = {**texts, interface: source(interface)}
    files = {f"sources/{file}": text.encode("utf-8") for file, text in sources.items()}
    if version == 2:
        files["modelDescription.xml"] = description_2(name, token, variables, run, units).encode("utf-8")
    else:
        files["modelDescription.xml"] = description_3(name, token, variables, run).encode("utf-8")
        files["sources/buildDescription.xml"] = build_description(name, units, defines).encode("utf-8")
    binary = f"binaries/{_platform(version)}/{identifier(name)}{ENDINGS.get(sys.platform, '.so')}"
    files[binary] = _compiled(sources, interface, library.real)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(files, key=lambda each: (each != "modelDescription.xml", each)):
            archive.writestr(zipfile.ZipInfo(path, DATE), files[path], zipfile.ZIP_DEFLATED)
    return out.getvalue()


def _platform(version: int) -> str:
    """The folder of the binary of this machine, as the version of FMI names it."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine())
    if version == 3:
        return f"{machine}-{sys.platform}"
    return sys.platform + ("64" if sys.maxsize > 2**32 else "32")


def _compiled(sources: Mapping[str, str], interface: str, real: str) -> bytes:
    """The shared library of an FMU, for any processor of this kind."""
    compiler = find_compiler()
    flags = portable_flags(compiler, real)
    core = runtime_object(compiler, flags)
    return shared_library(compiler, flags, sources, ("scene.c", "fmu.c", interface, str(core)))
