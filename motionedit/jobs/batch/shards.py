"""A share of a batch, for one machine of several: a clip's name alone says which it belongs to."""

from __future__ import annotations

import hashlib
import os
import re

from motionedit.dataclass import dataclass
from motionedit.errors import UsageError

_SHARD = re.compile(r"([0-9]{1,9})/([0-9]{1,9})", re.ASCII)


@dataclass(frozen=True)
class Shard:
    """Shard `index` of `count`, counted from 1."""

    index: int
    count: int

    def __str__(self) -> str:
        return f"{self.index}/{self.count}"

    def has(self, relative: str) -> bool:
        """Tell whether a clip, by its path below the folder given, belongs to this shard.

        The SHA-256 of the name, a whole number, modulo `count` is `index` - 1. No other clip has a part in it, so that
        one more moves none; the bytes of the name are those of the disk, whatever the locale.
        """
        digest = hashlib.sha256(os.fsencode(relative)).digest()
        return int.from_bytes(digest, "big") % self.count == self.index - 1


def shard_of(text: str) -> Shard:
    """Return the shard that a text such as ``3/16`` means.

    Raises
    ------
    UsageError
        It is none.
    """
    found = _SHARD.fullmatch(text)
    index, count = map(int, found.groups()) if found else (0, 0)
    if count and 1 <= index <= count:
        return Shard(index, count)
    remedy = f"count shards from 1: 1/{count} to {count}/{count}" if count else "give K/N, such as 3/16"
    raise UsageError(f"--shard {text}: no such shard; {remedy}")
