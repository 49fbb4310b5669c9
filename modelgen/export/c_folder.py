"""`--to c`: a folder of C99 that runs a scene, with an example, a self-test, and what it needs in memory."""

from __future__ import annotations

from collections.abc import Mapping

from modelgen.codegen.amalgamation import HEADER, SOURCE, header_text, runtime_text
from modelgen.codegen.emit import Package
from modelgen.codegen.library import REAL_FLAGS, Library
from modelgen.export.memory_footprint import Footprint, footprint_of
from modelgen.export.reference_vectors import Vectors, vectors_of
from modelgen.export.scene_header_and_tables import scene_files, source
from modelgen.runtime.core_session import Session
from modelgen.runtime.settings import accuracy_of


def c_files(library: Library, package: Package, measured: bool = True) -> dict[str, str]:
    """The texts of the folder, by name; `measured`: with what it needs, for which it is compiled."""
    accuracy = accuracy_of(library.manifest.instance, None, {})
    vectors = vectors_of(library, accuracy)
    session = Session(library, accuracy)
    defines = REAL_FLAGS[library.real]
    compiled = program_files(session, package)
    files = {
        **compiled,
        "vectors.h": vectors.text,
        **{name: source(name) for name in ("example.c", "selftest.c")},
        "CMakeLists.txt": source("CMakeLists.txt").replace("@DEFINITIONS@", " ".join(defines)),
    }
    figures = footprint_of(compiled, defines) if measured else None
    why_none = "gcc is needed for that" if measured else "the export was made with `--no-figures`"
    return {**files, "README.md": _readme(session, vectors, figures or why_none, defines)}


def program_files(session: Session, package: Package) -> dict[str, str]:
    """What a program of a scene is compiled of: core, kernels and tables."""
    texts = {name: text for name, text in package.files.items() if name.endswith(".c")}
    return {**texts, HEADER: header_text(), SOURCE: runtime_text(package.derivatives), **scene_files(session)}


def _readme(session: Session, vectors: Vectors, figures: Footprint | str, defines: tuple[str, ...]) -> str:
    flags = " ".join(["cc", "-std=c99", "-O2", "-ffp-contract=off", *defines, "scene.c", SOURCE])
    defined = f"Every file is compiled with `{' '.join(defines)}`.\n" if defines else ""
    return source("c_readme.md").format(
        name=session.instance["name"],
        real=session.library.real,
        compile=flags,
        count=vectors.count,
        defined=defined,
        interface=_interface(session),
        vectors=_told(vectors),
        figures=_table(figures, session.library.manifest.functions),
    )


def _interface(session: Session) -> str:
    lines = []
    for each in session.instance["inputs"]:
        range_ = f"{each['minimum']} to {each['maximum']}" if each["minimum"] is not None else "any"
        how = "scene_set_rate" if each["hold"] == "linear" else "scene_set_input"
        lines.append(f"| input `{each['name']}` | {each['unit'] or '-'} | {range_} | `{how}` |")
    for name, size in session.instance["sensors"]["names"]:
        lines.append(f"| sensor `{name}` | SI | {size} components | `scene_sense` |")
    if not lines:
        return "The scene has neither inputs nor sensors; `scene_poses` writes where its bodies are.\n"
    return "\n".join(["| | unit | | function |", "| --- | --- | --- | --- |", *lines, ""])


def _told(vectors: Vectors) -> str:
    return (
        f"The run of modelgen has the statement: {vectors.statement}. Of {vectors.count} states"
        f" {vectors.compared} are compared, within ten times that estimate up to each of them; the others"
        " have none. In double precision all are equal to the last bit."
        " The self-test also saves a state on the way, goes on from it, and compares the ends bit for bit."
    )


def _table(figures: Footprint | str, functions: Mapping[str, Mapping[str, int]]) -> str:
    """What it needs; `figures`: in their place, why they were not measured."""
    lines = ["| | |", "| --- | --- |"]
    if isinstance(figures, Footprint):
        if figures.flash is not None:
            code, constants = figures.flash
            lines.append(f"| flash | {code} bytes of code, {constants} bytes of constants |")
        rest = figures.instance - figures.work - figures.iwork
        lines.append(
            f"| RAM of one run | {figures.instance} bytes: {rest} state and events, {figures.work} and"
            f" {figures.iwork} scratch memory, which runs may share |"
        )
        if figures.stack is not None:
            least = "at least " if figures.recursive else ""
            beyond = f" (`{'`, `'.join(figures.recursive)}` call themselves)" if figures.recursive else ""
            chain = "bytes in the deepest chain of calls, the C library left out"
            lines.append(f"| stack | {least}{figures.stack} {chain}{beyond} |")
        if figures.evaluation is not None:
            lines.append(
                f"| right-hand side at the start | {figures.evaluation} instructions; a smooth step takes 12"
                " evaluations (dop853) or 4 (rk4), and its checks |"
            )
    total = sum(entry["instructions"] for entry in functions.values())
    lines.append(f"| all kernels, once each | {total} operations |")
    if isinstance(figures, str):
        return "\n".join([*lines, "", f"Flash, RAM and stack were not measured: {figures}."])
    return "\n".join(
        [*lines, "", f"Measured with {figures.machine}, `-O2`.", *(f"{why}." for why in figures.why)]
    )
