"""The errors of one clip, collected so that all of them are said at once."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, TypeVar

from motionedit.dataclass import dataclass
from motionedit.errors import MotionEditError, together

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

Found = TypeVar("Found")

# What stands between a joint that a clip lacks and the names of those that it has.
ITS_JOINTS = "; its joints are "


@dataclass(frozen=True)
class Faults:
    """Errors found so far, one at each place: what stands once in a spec may be looked at for several constraints."""

    errors: list[MotionEditError] = field(default_factory=list)

    def add(self, error: MotionEditError) -> None:
        """Keep an error, or each of a group, unless its place has one."""
        for found in error.errors:
            if (found.file, found.line, found.key) not in [(one.file, one.line, one.key) for one in self.errors]:
                self.errors.append(found)

    def get(self, look: Callable[[], Found], *, otherwise: Found) -> Found:
        """Return what `look` finds; where it raises, keep the error and return the stand-in."""
        try:
            return look()
        except MotionEditError as error:
            self.add(error)
            return otherwise

    def raise_all(self, what: str) -> None:
        """Raise the errors, if there are any.

        Raises
        ------
        MotionEditError
            The one there is, or all of them.
        """
        if self.errors:
            raise together(what, _joints_listed_once(self.errors))


def _joints_listed_once(errors: Sequence[MotionEditError]) -> list[MotionEditError]:
    """Return errors of which the first alone lists a clip's joints: one list serves all names that are not there."""
    listed, found = set(), []
    for error in errors:
        message, sign, names = error.message.partition(ITS_JOINTS)
        again = sign and names in listed
        listed.add(names)
        found.append(type(error)(message, file=error.file, line=error.line, key=error.key) if again else error)
    return found
