"""The program, as `motionedit` and as `python -m motionedit`: Ctrl-C is one line from its first import on."""

from __future__ import annotations

import sys


def main() -> None:
    """Run one command line, and exit with its code."""
    try:
        # Inside, since any import may be interrupted.
        import signal

        from motionedit.interrupts import leave_at_once

        leave_at_once()
        from motionedit.cli import main as program

        try:
            program()
        finally:
            # All is written and said: what the interpreter still does to end is not worth a traceback.
            signal.signal(signal.SIGINT, signal.SIG_DFL)
    except KeyboardInterrupt:  # before the first is answered, or while one is
        sys.stderr.write("motionedit: error: interrupted\n")
        sys.exit(130)


if __name__ == "__main__":
    main()
