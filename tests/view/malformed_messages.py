"""Messages to the live page that no page sends."""

from __future__ import annotations

import msgspec
import numpy as np

from modelgen.view.live_server import Live


def malformed(live: Live, rng: np.random.Generator) -> bytes | str:
    """Bytes, texts, unknown kinds, properties and values of controls."""
    control = [live.running, live.speed, live.inputs["torque"], live.reset][rng.integers(4)]
    name = ["value", "min", "max", "update_cb", "removed", "no_such"][rng.integers(6)]
    value = [np.nan, np.inf, 1e308, -1, "torque", None, [], {}, b"\0", True][rng.integers(10)]
    update = {"type": "GuiUpdateMessage", "uuid": control._impl.uuid, "updates": {name: value}}
    whole = msgspec.msgpack.encode(update)
    return [
        rng.bytes(int(rng.integers(200))), "text", whole, whole[: int(rng.integers(len(whole)))],
        msgspec.msgpack.encode({"type": "NoSuchMessage"}), msgspec.msgpack.encode([1, 2]),
    ][rng.integers(6)]  # fmt: skip
