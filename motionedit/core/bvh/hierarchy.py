"""The HIERARCHY of a BVH file: from its words to a skeleton, without recursion."""

from __future__ import annotations

import re
from dataclasses import field
from functools import lru_cache
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.scan import LARGEST_LENGTH, number, quoted, text_of
from motionedit.core.bvh.words import Words, is_count, shown
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.dataclass import dataclass
from motionedit.errors import BvhError

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Real rigs stay under a thousand joints; the limit keeps a hostile file from taking minutes.
MAX_JOINTS = 2_000

_CHANNELS = {f"{axis}{kind}".lower().encode(): f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation")}
_KEYWORDS = frozenset((b"root", b"joint", b"end", b"offset", b"channels", b"motion", b"hierarchy"))
_LINE_BREAK = re.compile(rb"[\r\n]")
_MOTION = re.compile(rb"[\r\n]MOTION\s", re.IGNORECASE)
_BOMS = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16"}
_UTF8_BOM = b"\xef\xbb\xbf"
# The clips of a batch mostly share their hierarchy to the byte; one of at most so many bytes is parsed once.
_SHARED_BYTES = 1 << 18


@dataclass
class _Joint:
    """A joint, or an End Site where `name` is None, whose block is being read."""

    name: str | None
    index: int
    parent: int
    offset: FloatArray | None = None
    channels: tuple[str, ...] | None = None
    has_child: bool = False
    shown: str = field(default="End Site")


def read_hierarchy(words: Words) -> Skeleton:
    """Return the skeleton of a file, and move past MOTION; `BvhError` with the line where it is not legal."""
    return _known(words) or _Parser(words).hierarchy()


@lru_cache(maxsize=4)
def _shared(text: bytes) -> tuple[Skeleton, int]:
    """Return the skeleton of a text that ends with MOTION, and the byte after that word."""
    words = Words(text, "")
    return _Parser(words).hierarchy(), words.at


# The last such text, with what is returned of it: a file that begins with it need not be searched for the word.
_LAST: list[tuple[bytes, Skeleton, int]] = []


def _known(words: Words) -> Skeleton | None:
    """Return the skeleton by way of the last files', None where this file has to be parsed by itself."""
    for text, skeleton, end in _LAST:
        if words.data.startswith(text):
            words.at = end
            return skeleton
    motion = _MOTION.search(words.data, 0, _SHARED_BYTES)
    if motion is None:
        return None
    text = words.data[: motion.end()]
    try:
        skeleton, words.at = _shared(text)
    except BvhError:  # to be said with this file's name
        return None
    _LAST[:] = [(text, skeleton, words.at)]
    return skeleton


class _Parser:
    def __init__(self, words: Words) -> None:
        self.words = words
        self.joints: list[_Joint] = []
        self.sites: list[EndSite] = []

    def hierarchy(self) -> Skeleton:
        self._first_word()
        word, at = self.words.word()
        if word.lower() != b"root":
            self.words.refuse(f"expected ROOT after HIERARCHY, found {shown(word)}", at)
        opened: list[_Joint] = []
        self._open(opened, word, at)
        while opened:
            word, at = self.words.word()
            block = opened[-1]
            key = word.lower()
            if key == b"offset":
                self._offset(block, at)
            elif key == b"channels":
                self._channels(block, at)
            elif key in (b"joint", b"end"):
                self._open(opened, word, at)
            elif word == b"}":
                self._close(opened.pop(), at)
            else:
                self._refuse_word(word, at, opened)
        word, at = self.words.word()
        if word.lower() != b"motion":
            self._refuse_after_root(word, at)
        if not any(joint.channels for joint in self.joints):
            self.words.refuse("the hierarchy has no channels, so no motion can be in this file", at)
        return self._skeleton()

    def _first_word(self) -> None:
        for mark, name in _BOMS.items():
            if self.words.data.startswith(mark):
                self.words.refuse(f"this is {name} text; save the file as UTF-8 or plain ASCII", 0)
        if self.words.data.startswith(_UTF8_BOM):
            self.words.at = len(_UTF8_BOM)
        word, at = self.words.word()
        if not word:
            self.words.refuse("the file is empty", 0)
        if b"\0" in word:
            self.words.refuse("NUL bytes: this is no text file (UTF-16 or binary); a BVH file is plain text", at)
        if word.lower() != b"hierarchy":
            self.words.refuse(f"expected HIERARCHY, found {quoted(word)}: not a BVH file", at)

    def _open(self, opened: list[_Joint], word: bytes, at: int) -> None:
        if opened and opened[-1].name is None:
            self.words.refuse(f"{text_of(word)} inside an End Site; an End Site holds only its OFFSET", at)
        rest = self.words.rest_of_line()
        parent = opened[-1].index if opened else -1
        if word.lower() == b"end":
            # "End Site" by the format; real files also number or name their ends, which says nothing.
            block = _Joint(None, -1, parent)
        else:
            if not rest:
                self.words.refuse(f"{text_of(word).upper()} without a name", at)
            if b"\0" in rest:
                self.words.refuse("NUL bytes in a joint's name: a BVH file is plain text", at)
            if len(self.joints) == MAX_JOINTS:
                self.words.refuse(f"more than {MAX_JOINTS} joints", at)
            block = _Joint(text_of(rest), len(self.joints), parent, shown=f"joint {quoted(rest)}")
            self.joints.append(block)
            if opened:
                opened[-1].has_child = True
        brace, place = self.words.word()
        if brace != b"{":
            where = place if brace else at
            self.words.refuse(f"expected '{{' after {block.shown}, found {shown(brace)}", where)
        opened.append(block)

    def _offset(self, block: _Joint, at: int) -> None:
        if block.offset is not None:
            self.words.refuse(f"a second OFFSET in {block.shown}", at)
        words = self._words_of_statement(3, most=4)
        if len(words) != 3:
            self.words.refuse(f"OFFSET of {block.shown} has {_count(words)} values, it needs 3", at)
        values = [number(word) for word, _ in words]
        for (word, place), value in zip(words, values, strict=True):
            if value is None:
                self.words.refuse(f"OFFSET of {block.shown}: {quoted(word)} is not a finite number", place)
            if abs(value) > LARGEST_LENGTH:
                self.words.refuse(f"OFFSET of {block.shown}: {quoted(word)} is beyond any length", place)
        block.offset = frozen(np.array(values, dtype=np.float64))

    def _channels(self, block: _Joint, at: int) -> None:
        if block.name is None:
            self.words.refuse("CHANNELS inside an End Site; an End Site holds only its OFFSET", at)
        if block.channels is not None:
            self.words.refuse(f"a second CHANNELS in {block.shown}", at)
        if block.has_child:
            self.words.refuse(f"CHANNELS of {block.shown} stands after a child; it must stand before", at)
        counts = self._words_of_statement(1, most=1)
        if not counts:
            self.words.refuse(f"CHANNELS of {block.shown} has no count", at)
        counted, place = counts[0]
        if not is_count(counted) or int(counted) > 6:
            self.words.refuse(f"CHANNELS of {block.shown}: {quoted(counted)} is not a count from 0 to 6", place)
        words = self._words_of_statement(int(counted), most=7)
        names = []
        for word, place in words:
            name = _CHANNELS.get(word.lower())
            if name is None:
                self.words.refuse(f"{block.shown}: unknown channel {quoted(word)}", place)
            if name in names:
                self.words.refuse(f"{block.shown}: channel {name} is repeated", place)
            names.append(name)
        if len(names) != int(counted):
            self.words.refuse(f"{block.shown} says {int(counted)} channels and names {len(names)}", at)
        block.channels = tuple(names)

    def _words_of_statement(self, needed: int, *, most: int) -> list[tuple[bytes, int]]:
        """Return the words up to a keyword, a brace, or, once there are enough, the line's end."""
        words: list[tuple[bytes, int]] = []
        while len(words) < most:
            before = self.words.at
            word, at = self.words.word()
            another_line = _LINE_BREAK.search(self.words.data, before, at) is not None
            if not word or word in (b"{", b"}") or word.lower() in _KEYWORDS:
                self.words.at = before
                break
            if len(words) >= needed and another_line:
                self.words.at = before
                break
            words.append((word, at))
        return words

    def _close(self, block: _Joint, at: int) -> None:
        if block.offset is None:
            self.words.refuse(f"{block.shown} has no OFFSET", at)
        if block.name is None:
            self.sites.append(EndSite(block.parent, block.offset))

    def _refuse_word(self, word: bytes, at: int, opened: list[_Joint]) -> NoReturn:
        if not word:
            self.words.refuse(f"the file ends inside {opened[-1].shown}: {len(opened)} '}}' missing", at)
        if word.lower() == b"motion":
            self.words.refuse(f"MOTION inside {opened[-1].shown}: {len(opened)} '}}' missing", at)
        if word.lower() == b"root":
            self.words.refuse(f"a ROOT inside {opened[-1].shown}; only one ROOT can be read", at)
        self.words.refuse(
            f"expected OFFSET, CHANNELS, JOINT, End Site or '}}' in {opened[-1].shown}, found {quoted(word)}", at
        )

    def _refuse_after_root(self, word: bytes, at: int) -> NoReturn:
        if word.lower() == b"root":
            self.words.refuse("a second ROOT; only one skeleton a file can be read", at)
        if word == b"}":
            self.words.refuse("a '}' too many", at)
        if not word:
            self.words.refuse("the file ends before MOTION", at)
        self.words.refuse(f"expected MOTION after the hierarchy, found {quoted(word)}", at)

    def _skeleton(self) -> Skeleton:
        joints = self.joints
        offsets = np.array([joint.offset for joint in joints], dtype=np.float64)
        return Skeleton(
            names=tuple(joint.name or "" for joint in joints),
            parents=frozen(np.array([joint.parent for joint in joints], dtype=np.intp)),
            offsets=frozen(offsets),
            channels=tuple(joint.channels or () for joint in joints),
            end_sites=tuple(self.sites),
        )


def _count(words: list[tuple[bytes, int]]) -> str:
    return str(len(words)) if len(words) < 4 else "more than 3"
