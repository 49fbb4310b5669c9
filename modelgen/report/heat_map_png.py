"""A grid of numbers in [-1, 1] as a PNG in a data URI: white is 1, blue small, black 0, red negative."""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Sequence

GAP = (230, 230, 230)  # where there is no number
NEAR = 1e-3  # black below


def data_uri(rows: Sequence[Sequence[float | None]]) -> str:
    """The last row on top, so that the second axis points up."""
    lines = b"".join(b"\0" + bytes(x for value in row for x in colour(value)) for row in reversed(rows))
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b""))
    png = b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(name, data) for name, data in chunks)
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")


def colour(mu: float | None) -> tuple[int, int, int]:
    """RGB."""
    if mu is None:
        return GAP
    if abs(mu) < NEAR:
        return 0, 0, 0
    share = min(abs(mu), 1.0) ** 0.5
    dark, light = ((20, 50, 110), (240, 248, 255)) if mu > 0 else ((120, 20, 30), (255, 205, 190))
    red, green, blue = (round(a + share * (b - a)) for a, b in zip(dark, light, strict=True))
    return red, green, blue


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
