"""The table [run] of a scene: how long, how accurately, by which method."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from modelgen.scene.run_choices import (
    ACCURACIES,
    APPROXIMATE,
    FORMS,
    IMPACTS,
    LEVELS,
    METHODS,
    REALS,
    SCHEMES,
    SOLVERS,
    STEPPED,
)
from modelgen.scene.scalar_types import POSITIVE, Choice, Real, Switch, Whole
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Table

_TOLERANCE = "a number is written tolerance = ..., without accuracy"

RUN = Table(
    (
        Field("until", POSITIVE, "end of the run, s", default=1.0),
        Field(
            "accuracy",
            Choice(ACCURACIES, _TOLERANCE),
            "how tightly every tolerance is set",
            default="balanced",
        ),
        Field("tolerance", Real(1e-18, 1e-2), "relative tolerance in place of the accuracy's"),
        Field(
            "imaginary_edge",
            Real(0.0, 1.0),
            "lean, rad, up to which a face turns on a tangent of its rim; 0: it rolls at once",
            default=0.0,
        ),
        Field(
            "flush_height",
            Real(0.0, 1e-2),
            "step, in characteristic lengths, up to which shapes that are fixed together join flush",
            default=1e-8,
        ),
        Field("samples", Whole(1, 1_000_000), "output intervals from 0 to until", default=200),
        Field("method", Choice(METHODS), "event-driven, adaptive or not, or time-stepping; else dop853"),
        Field("step", POSITIVE, "fixed step of rk4 and time-stepping, s"),
        Field("scheme", Choice(SCHEMES), "of time-stepping; else stewart-trinkle"),
        Field(
            "solver",
            Choice(SOLVERS),
            "solves for forces and impulses; else coulomb, or qp without friction",
        ),
        Field(
            "fallback",
            Switch(),
            "continue by time-stepping where events cannot be located or cost too much; else true",
        ),
        Field("impacts", Choice(IMPACTS), "impacts at several contacts: simultaneous or one after another"),
        Field("newton", Whole(0, 2), "corrections of contact points: none, once a step, at every stage"),
        Field("project", Whole(0, 1_000_000), "remove drift every so many steps; 0: never"),
        Field("use_gamma", Switch(), "false drops the velocity term Gamma2"),
        Field("estimate", Switch(), "estimate the error by a second, finer run; else true"),
        Field("form", Choice(FORMS), "form of contacts that name none, where it is regular"),
        Field("real", Choice(REALS), "the real type of the library"),
        Field("level", Choice(LEVELS), "how far the compiler optimises"),
    )
)


def check_run(run: Mapping[str, Any], place: Place) -> None:
    """Raise SceneError for keys of another method, and for a step that is longer than the run."""
    stepped = [("step", STEPPED), ("scheme", STEPPED[1:])]
    if run["solver"] in APPROXIMATE:
        stepped += [("solver", STEPPED[1:])]
    method = run["method"] or ("time-stepping" if run["accuracy"] == "coarse" else None)
    for key, methods in stepped:
        if run[key] is not None and method not in methods:
            allowed = "method = " + " or ".join(f'"{name}"' for name in methods) + " with it"
            raise place.key(key).error(repr(run[key]), allowed, "give both, or neither")
    if run["step"] is not None and run["step"] > run["until"]:
        found = f"a step of {run['step']:g} s, longer than the run of {run['until']:g} s"
        raise place.key("step").error(found, "a step is a part of the run", "shorten it, or extend until")
