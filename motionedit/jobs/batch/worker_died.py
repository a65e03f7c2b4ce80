"""What comes in place of the result of a worker that died."""

from __future__ import annotations

from motionedit.errors import MotionEditError


class WorkerDiedError(MotionEditError):
    """The process that worked on an item ended without an answer: killed, most often for want of memory."""
