"""The exception tree: what went wrong, in which file, at which line, under which key, and the exit code it means."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

EXIT_DONE = 0
EXIT_CLIP_FAILED = 1
EXIT_USAGE = 2
EXIT_OUT_OF_TOLERANCE = 3
EXIT_INTERRUPTED = 130


# The statuses of clips that --strict counts: a goal that was not met, an edit that a viewer would see.
MISSED = frozenset({"rough", "out_of_tolerance", "unreachable"})


class MotionEditError(Exception):
    """Root of all errors that a user can cause; `str()` is one line, ``FILE:LINE: KEY: what; remedy``.

    Parameters
    ----------
    message : str
        What is wrong and what would be right, on one line.
    file, line, key
        Where it was found; each is left out of the line when unknown. Lines count from 1.
    """

    exit_code = EXIT_CLIP_FAILED

    def __init__(
        self, message: str, *, file: str | None = None, line: int | None = None, key: str | None = None
    ) -> None:
        super().__init__(message, file, line, key)
        self.message = message
        self.file = file
        self.line = line
        self.key = key

    @property
    def errors(self) -> tuple[MotionEditError, ...]:
        """The faults one by one: itself, or those of a group and of the groups in it, in order."""
        return (self,)

    def __reduce__(self) -> tuple[object, ...]:
        # Keyword-only arguments do not survive the default pickling between worker processes.
        return _rebuild, (type(self), self.message, self.file, self.line, self.key)

    def __str__(self) -> str:
        place = self.file or ""
        if self.file and self.line is not None:
            place = f"{self.file}:{self.line}"
        return ": ".join(part for part in (place, self.key, self.message) if part)


def _rebuild(
    kind: type[MotionEditError], message: str, file: str | None, line: int | None, key: str | None
) -> MotionEditError:
    return kind(message, file=file, line=line, key=key)


class UsageError(MotionEditError):
    """The command line itself asks for something that cannot be: nothing was started."""

    exit_code = EXIT_USAGE


class SpecError(MotionEditError):
    """One fault of a spec file: nothing was started."""

    exit_code = EXIT_USAGE


class ModelError(MotionEditError):
    """A model or normalization file that cannot be used: nothing was started."""

    exit_code = EXIT_USAGE


class ClipError(MotionEditError):
    """A clip that cannot be worked on; other clips go on."""


class BvhError(ClipError):
    """A BVH file that cannot be read, or would not be read back."""


class MotionEditErrors(ExceptionGroup[MotionEditError], MotionEditError):  # type: ignore[override]  # noqa: N818  of both
    """Several faults found together, such as all those of one spec file; `str()` has a line for each.

    Whoever catches MotionEditError catches these too; `except*` takes them apart by their kinds.
    """

    def __init__(self, message: str, faults: Sequence[MotionEditError]) -> None:
        del message  # kept by the group, which was made of both
        self.file = self.line = self.key = None
        self.exit_code = max(fault.exit_code for fault in faults)

    @property
    def errors(self) -> tuple[MotionEditError, ...]:
        """The faults one by one, those of groups in it too, in order."""
        known = [fault for fault in self.exceptions if isinstance(fault, MotionEditError)]
        return tuple(error for fault in known for error in fault.errors)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), self.args

    def __str__(self) -> str:
        return "\n".join(map(str, self.errors))


def together(message: str, faults: Sequence[MotionEditError]) -> MotionEditError:
    """Return faults as one error, to be raised: the fault itself where there is one alone, else a group."""
    return faults[0] if len(faults) == 1 else MotionEditErrors(message, faults)
