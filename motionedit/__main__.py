"""The program, as `motionedit` and as `python -m motionedit`: Ctrl-C is one line from its first import on."""

from __future__ import annotations

import signal
import sys

from motionedit.interrupts import EXIT_CODE, INTERRUPTED, leave_at_once


def main() -> None:
    """Run one command line, and exit with its code."""
    leave_at_once()
    try:
        from motionedit.cli import main as program

        program()
    except KeyboardInterrupt:  # while it was said that one was answered
        sys.stderr.write(INTERRUPTED)
        sys.exit(EXIT_CODE)
    finally:
        # All is written and said: what the interpreter still does to end is not worth a traceback.
        signal.signal(signal.SIGINT, signal.SIG_DFL)


if __name__ == "__main__":
    main()
