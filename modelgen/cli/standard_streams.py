"""Standard streams that end the command once nobody takes what it prints: quietly where nobody reads it any
more, as `head` when it has enough, and with a message where it cannot be written."""

from __future__ import annotations

import codecs
import io
import os
import sys

CLOSED = 141  # 128 and the number of SIGPIPE, as shells have it
FAILED = 2  # as of every file that cannot be written
ANYWAY = "modelgen.anyway"  # how what the encoding of a stream lacks is written


class Output(io.TextIOWrapper):
    """A stream that raises SystemExit when it cannot be written, and loses what is written from then on.

    Standard error that is full or closed ends nothing.
    """

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except OSError as error:
            self._end(error)
            return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError as error:
            self._end(error)

    def _end(self, error: OSError) -> None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
        if isinstance(error, BrokenPipeError):
            raise SystemExit(CLOSED)
        if self.fileno() != 2:
            print(f"standard output: {error.strerror}; write it to another place", file=sys.stderr)
            raise SystemExit(FAILED)


def _written_anyway(error: UnicodeError) -> tuple[bytes, int]:
    """The bytes of names of files that are no text, as they are; escapes of other letters."""
    assert isinstance(error, UnicodeEncodeError)
    letters = error.object[error.start : error.end]
    raw = (
        bytes([ord(each) - 0xDC00])
        if 0xDC80 <= ord(each) <= 0xDCFF
        else each.encode("ascii", "backslashreplace")
        for each in letters
    )
    return b"".join(raw), error.end


codecs.register_error(ANYWAY, _written_anyway)


def guard_streams() -> None:
    """Let standard output and standard error be such streams.

    Standard output that is closed cannot be written; what goes to closed standard error is lost, also from
    programs that are started, some of which fail without one.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:  # or the next file that is opened would be that stream
            os.set_inheritable(os.open(os.devnull, os.O_WRONLY if number == 2 else os.O_RDONLY), True)
    for number, name in ((1, "stdout"), (2, "stderr")):
        stream = getattr(sys, name) or io.TextIOWrapper(io.FileIO(number, "w"), "utf-8", write_through=True)
        if isinstance(stream, io.TextIOWrapper):
            encoding, errors, by_line = stream.encoding, stream.errors, stream.line_buffering
            at_once, raw = stream.write_through, stream.detach()
            errors = ANYWAY if errors == "strict" else errors
            output = Output(raw, encoding, errors, line_buffering=by_line, write_through=at_once)
            setattr(sys, name, output)
