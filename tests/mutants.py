"""Damaged copies of bytes and texts."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from math import inf, nan
from random import Random

ODD_NUMBERS = (
    *("0", "-0.0", "-1", "1e302", "-1e302", "9.9e307", "1e-320", "nan", "inf", "-inf", "1e9999"),
    *("0x10", "1_000", "1,5", "", "1e", "true", '"1"', "[1]", "9" * 400, "1e16", "4294967296"),
)
ENCODINGS = {  # declared, and written in
    **{name: name for name in ("shift_jis", "gbk", "utf-7", "utf-16", "utf-32", "latin-1", "cp037")},
    **{"nonsense": "utf-8", "idna": "utf-8", "rot13": "utf-8", "base64": "utf-8", "utf-8": "utf-16-le"},
}
ODD_CHARACTERS = "\0\x01\x1b\x7f\x85\u200b\u2028\ufeff\ufffe\U0001f600é\n\r\t\"'\\%{}[]()<>&#;,."
DEEP = (1000, 100_000)
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
TOKEN = re.compile(r"\w+|[^\w\s]")


def mutants(whole: bytes, count: int, seed: int = 50) -> Iterator[bytes]:
    """`count` damaged copies."""
    draw, number = Random(seed), 0
    while number < count:
        mutant = damaged(whole, draw, number)
        if mutant != whole:
            number += 1
            yield mutant


def damaged(whole: bytes, draw: Random, kind: int) -> bytes:
    """What errors of a disk or a hand leave: bits flipped, cut, longer, parts replaced, exchanged or zero."""
    a, b = sorted(draw.sample(range(len(whole)), 2))
    part = whole[a:b]
    return (
        whole[:a] + bytes([whole[a] ^ 1 << draw.randrange(8)]) + whole[a + 1 :],
        whole[:b],
        whole + draw.randbytes(8),
        whole[:a] + draw.randbytes(len(part)) + whole[b:],
        whole[:a] + struct.pack("<d", draw.choice((-1e300, 1e-300, inf, nan))) + whole[a + 8 :],
        whole[:8] + part + whole[8 + len(part) :],
        whole[:a] + bytes(len(part)) + whole[b:],
    )[kind % 7]


def text_mutant(whole: str, draw: Random, kind: int) -> bytes:
    """What errors of a hand or of another program leave of a text: numbers far out, words exchanged, missing
    or repeated, lines missing, doubled or exchanged, long names, odd characters, other encodings, deep
    nesting; one kind of eight is `damaged`."""
    lines = whole.splitlines()
    a, b = (draw.randrange(len(lines)) for _ in range(2))
    match kind % 16:
        case 0 | 1:
            return _replaced(whole, NUMBER, draw, lambda _: draw.choice(ODD_NUMBERS))
        case 2:
            scale = 10.0 ** draw.randint(-12, 12)
            return _replaced(whole, NUMBER, draw, lambda found: f"{float(found) * scale:g}")
        case 3:
            for _ in range(draw.randint(2, 6)):
                whole = _replaced(whole, NUMBER, draw, lambda _: draw.choice(ODD_NUMBERS)).decode()
        case 4:
            return _replaced(whole, TOKEN, draw, lambda _: draw.choice(TOKEN.findall(whole)))
        case 5:
            return _replaced(whole, TOKEN, draw, lambda _: "")
        case 6:
            return _replaced(whole, TOKEN, draw, lambda found: found * draw.choice((2, 3, 1000, 100_000)))
        case 7:
            return _replaced(whole, re.compile(r"[A-Za-z_]\w*"), draw, lambda found: found[:1] * 10_000)
        case 8:
            del lines[a]
            return "\n".join(lines).encode()
        case 9:
            return "\n".join((*lines[:a], *lines[min(a, b) : max(a, b) + 1], *lines[a:])).encode()
        case 10:
            lines[a], lines[b] = lines[b], lines[a]
            return "\n".join(lines).encode()
        case 11:
            at = draw.randrange(len(whole))
            return (whole[:at] + draw.choice(ODD_CHARACTERS) + whole[at:]).encode()
        case 12:
            declared, written = draw.choice(list(ENCODINGS.items()))
            head = f'<?xml version="1.0" encoding="{declared}"?>\n' if whole.startswith("<") else "# é\n"
            return (head + whole).encode(written, "replace")
        case 13:
            return _nested(whole, draw).encode()
        case _:
            return damaged(whole.encode(), draw, draw.randrange(7))
    return whole.encode()


def _replaced(whole: str, pattern: re.Pattern[str], draw: Random, by: Callable[[str], str]) -> bytes:
    """The text with one match of a pattern replaced."""
    found = list(pattern.finditer(whole))
    if not found:
        return whole.encode()
    one = draw.choice(found)
    return (whole[: one.start()] + by(one[0]) + whole[one.end() :]).encode()


def _nested(whole: str, draw: Random) -> str:
    """Brackets or elements around a word, many times."""
    count = draw.choice(DEEP)
    words = re.findall(r"<(\w+)", whole)
    pairs = [(f"<{word}>", f"</{word}>") for word in words] or [
        ("[", "]"),
        ("(", ")"),
        ("{a=", "}"),
        ("-", ""),
    ]
    begins, ends = draw.choice(pairs)
    one = draw.choice(list(re.finditer(r"<\w+[^>]*>" if words else TOKEN, whole)))
    inner = one[0] if not words else ""
    outer = one[0] if words else ""
    end = ends * count if draw.random() < 0.7 else ""
    return whole[: one.start()] + outer + begins * count + inner + end + whole[one.end() :]
