"""What comes in place of a result that a worker could not give."""

from __future__ import annotations

from motionedit.errors import MotionEditError


class WorkerDiedError(MotionEditError):
    """The process that worked on an item ended without an answer: killed, most often for want of memory."""


class ClusterLostError(WorkerDiedError):
    """The whole cluster went away: the same for all items that were left."""


class Raised:
    """An exception of the function, on its way to where the results are taken."""

    def __init__(self, error: BaseException) -> None:
        self.error = error
