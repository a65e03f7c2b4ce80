"""Whether a file that a worker elsewhere wrote has come here: it may have other folders by the same names."""

from __future__ import annotations

import hashlib
import os
import time
from typing import TYPE_CHECKING

from motionedit.errors import ClipError
from motionedit.jobs.batch.one_clip import Done
from motionedit.regular_files import read_file

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.jobs.batch.plan import ClipTask

# In all: a shared file system shows what another machine wrote within some seconds, or it is not shared.
SECONDS_TO_ARRIVE = 10.0
_SECONDS_BETWEEN_LOOKS = 0.2


class Arrivals:
    """What a cluster says that it wrote, as it is seen from here."""

    def __init__(self) -> None:
        self._patience = SECONDS_TO_ARRIVE

    def checked(self, task: ClipTask, done: Done) -> Done:
        """Return what a worker says of its clip; a failure where what it wrote is not here."""
        if task.output is None or done.digest is None:
            return done
        while not _is_here(task.output, done.digest):
            if self._patience <= 0.0:
                message = "its worker wrote it, but it is not here: give an output that all machines share"
                return Done(errors=(ClipError(message, file=str(task.output)),), seconds=done.seconds)
            self._patience -= _SECONDS_BETWEEN_LOOKS
            time.sleep(_SECONDS_BETWEEN_LOOKS)
        return done


def _is_here(path: Path, digest: str) -> bool:
    try:
        os.scandir(path.parent).close()  # a network's file system then asks anew what is in the folder
        return hashlib.sha256(read_file(path)).hexdigest() == digest
    except OSError:
        return False
