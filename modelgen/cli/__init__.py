"""The command line: one command for each step of the pipeline, and what it prints.

Exit codes: 0 done; 1 the run ended early (what it computed is written); 2 bad input (nothing is written);
130 interrupted (what was computed is written; nothing where nothing was); 141 nobody reads the output.
"""

import signal
import sys

from modelgen.cli.standard_streams import guard_streams

INTERRUPTED = 130  # 128 and the number of the signal, as shells have it


def main() -> None:
    """Run the command line. Ctrl-C and SIGTERM end it without a traceback, also in the imports."""
    guard_streams()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        from modelgen.cli.command_group import app

        app()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
