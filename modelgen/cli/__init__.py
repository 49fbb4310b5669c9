"""The command line: one command for each step of the pipeline, and what it prints.

Exit codes: 0 done; 1 the run ended early (what it computed is written); 2 bad input (nothing is written);
130 interrupted (what was computed is written; nothing where nothing was); 141 nobody reads the output.
"""

import os
import resource
import sys

from modelgen.cli.standard_streams import FAILED, guard_streams
from modelgen.interruption import hear_no_more, hear_signals, was_heard

INTERRUPTED = 130  # 128 and the number of the signal, as shells have it
LEAST_STACK = 256  # KiB; C compilers and derivations end with a violation of memory below some 100


def main() -> None:
    """Run the command line. Ctrl-C and SIGTERM end it without a traceback, also in the imports."""
    hear_signals()
    try:
        guard_streams()
        _check_stack()
        from modelgen.cli.command_group import app

        app()
    except (KeyboardInterrupt, Exception) as error:
        if not isinstance(error, KeyboardInterrupt) and not was_heard():
            raise  # another may come of what CasADi makes where it swallows an interruption
        hear_no_more()
        print("interrupted", file=sys.stderr)
        _leave(INTERRUPTED)
    except SystemExit as end:
        hear_no_more()
        if was_heard():
            _leave(INTERRUPTED if end.code == 1 else end.code)  # 1: the parser of commands heard it
        raise


def _check_stack() -> None:
    """End the process where its stack, or that of a compiler which it starts, would overflow."""
    size, _ = resource.getrlimit(resource.RLIMIT_STACK)
    if size != resource.RLIM_INFINITY and size < 1024 * LEAST_STACK:
        found = f"its limit is {size // 1024} KiB; at least {LEAST_STACK} KiB are needed"
        print(f"stack: {found}; run `ulimit -s 8192` before", file=sys.stderr)
        raise SystemExit(FAILED)


def _leave(code: str | int | None) -> None:
    """End a process that was interrupted. Python ends as killed by SIGINT, whatever code it is given, if
    KeyboardInterrupt came up in text that it executed, as modules of dataclasses do; and it would wait for
    threads, which may wait for a lock that the interruption left taken."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else 0)
