"""The symbols that a shared library defines for others, read from the file: ELF, 64 bit, little endian."""

from __future__ import annotations

import struct
from pathlib import Path

DYNAMIC_SYMBOLS, FUNCTION_OR_DATA, GLOBAL_OR_WEAK = 11, (0, 1, 2), (1, 2)


def defined_symbols(path: Path) -> set[str]:
    """Names in the table of dynamic symbols that have a place in the file and are visible."""
    data = path.read_bytes()
    if data[:6] != b"\x7fELF\x02\x01":
        raise ValueError(f"{path}: no 64-bit little-endian ELF file")
    (start,), (size, count) = struct.unpack_from("<Q", data, 0x28), struct.unpack_from("<HH", data, 0x3A)
    headers = [struct.unpack_from("<IIQQQQIIQQ", data, start + k * size) for k in range(count)]
    found = set()
    for header in headers:
        if header[1] != DYNAMIC_SYMBOLS:
            continue
        names = headers[header[6]][4]
        for at in range(header[4], header[4] + header[5], header[9]):
            name, info, other, section, _, _ = struct.unpack_from("<IBBHQQ", data, at)
            visible = info >> 4 in GLOBAL_OR_WEAK and other & 3 == 0
            if section and visible and info & 15 in FUNCTION_OR_DATA:
                end = data.index(b"\0", names + name)
                found.add(data[names + name : end].decode())
    return found
