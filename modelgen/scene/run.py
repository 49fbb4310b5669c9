"""The table [run] of a scene: how long, how accurately, by which method."""

from __future__ import annotations

from modelgen.scene.fields import Field, Table
from modelgen.scene.scalars import POSITIVE, Choice, Real, Switch, Whole

ACCURACIES = ("fast", "balanced", "tight")
METHODS = ("dop853", "rk4", "time-stepping")
SCHEMES = ("stewart-trinkle", "anitescu-potra", "moreau")
SOLVERS = ("coulomb", "relaxation")

RUN = Table(
    (
        Field("until", POSITIVE, "end of the run, s", default=1.0),
        Field("accuracy", Choice(ACCURACIES), "how tightly every tolerance is set", default="balanced"),
        Field("tolerance", Real(1e-18, 1e-2), "relative tolerance in place of the accuracy's"),
        Field(
            "imaginary_edge",
            Real(0.0, 1.0),
            "lean, rad, up to which a face turns on a tangent of its rim; 0: it rolls at once",
            default=0.0,
        ),
        Field("samples", Whole(1, 1_000_000), "output intervals from 0 to until", default=200),
        Field("method", Choice(METHODS), "event-driven, adaptive or not, or time-stepping; else dop853"),
        Field("step", POSITIVE, "fixed step of rk4 and time-stepping, s"),
        Field("scheme", Choice(SCHEMES), "of time-stepping; else stewart-trinkle"),
        Field("solver", Choice(SOLVERS), "friction in time-stepping: Coulomb's law or its convex relaxation"),
        Field("fallback", Switch(), "time-stepping for a while where an event-driven run ends; else true"),
    )
)
