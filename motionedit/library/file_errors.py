"""What the system says of files and folders, as errors of the face."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from motionedit.errors import MotionEditError

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextlib.contextmanager
def file_errors() -> Iterator[None]:
    """Raise an OSError, such as that of a folder that may not be read, as a MotionEditError; a decorator, too."""
    try:
        yield
    except OSError as error:
        file = None if error.filename is None else str(error.filename)
        raise MotionEditError(error.strerror or str(error), file=file) from error
