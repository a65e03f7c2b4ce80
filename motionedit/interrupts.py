"""Ctrl-C: at once while nothing is written, by way of a KeyboardInterrupt from then on.

An exception may come at any place, and in some, such as the end of an import, Python itself drops it. While there is
nothing to clean up no exception is needed.
"""

from __future__ import annotations

import os
import signal
from functools import cache

TYPE_CHECKING = False  # typing's takes longer to load than all that stands here
if TYPE_CHECKING:
    from types import FrameType

_INTERRUPTED = "motionedit: error: interrupted\n"
_EXIT_CODE = 130


def leave_at_once() -> None:
    """Let Ctrl-C end the program with its line and its exit code, where it is not ignored (a job in the background)."""
    clean_up_first.cache_clear()
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)


@cache  # asked for each file that is written, it is done once
def clean_up_first() -> None:
    """Let Ctrl-C raise a KeyboardInterrupt again: there are files or workers now that must not be left behind."""
    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _leave(_signal: int, _frame: FrameType | None) -> None:
    os.write(2, _INTERRUPTED.encode())
    os._exit(_EXIT_CODE)
