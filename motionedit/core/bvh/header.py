"""The HIERARCHY of a BVH file and the two lines under MOTION: from text to a skeleton, without recursion."""

from __future__ import annotations

import re
from dataclasses import field
from functools import lru_cache
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.scan import LARGEST_LENGTH, WORD_LENGTH, number, quoted, refusal, text_of
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.dataclass import dataclass
from motionedit.errors import BvhError

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Real rigs stay under a thousand joints; the limit keeps a hostile file from taking minutes.
MAX_JOINTS = 2_000

_CHANNELS = {f"{axis}{kind}".lower().encode(): f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation")}
_KEYWORDS = frozenset((b"root", b"joint", b"end", b"offset", b"channels", b"motion", b"hierarchy"))
# Possessive, so that a file of blanks is walked once; the length is bounded, so that a word without end is cut.
_WORD = re.compile(rb"\s*+([{}]|[^\s{}]{1,%d}+)" % (WORD_LENGTH + 1))
_REST_OF_LINE = re.compile(rb"[^\r\n{}]*+")
_LINE_BREAK = re.compile(rb"[\r\n]")
_FRAMES = re.compile(rb"\s*(Frames[ \t]*:)[ \t]*([^\r\n]*)", re.IGNORECASE)
_FRAME_TIME = re.compile(rb"\s*(Frame[ \t]*Time[ \t]*:)[ \t]*([^\r\n]*)", re.IGNORECASE)
_MOTION = re.compile(rb"[\r\n]MOTION\s", re.IGNORECASE)
_COUNT = re.compile(rb"[0-9]{1,15}")
_BOMS = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16"}
_UTF8_BOM = b"\xef\xbb\xbf"
# The clips of a batch mostly share their hierarchy to the byte; one of at most so many bytes is parsed once.
_SHARED_BYTES = 1 << 18


@dataclass(frozen=True, eq=False)
class Header:
    """What stands above the rows.

    `frames_span` and `frame_time_span` are the (start, stop) bytes of the two numbers; `rows_start` is the byte
    where the line of the frame time ends.
    """

    skeleton: Skeleton
    frames: int
    frame_time: float
    frames_span: tuple[int, int]
    frame_time_span: tuple[int, int]
    rows_start: int


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


def read_header(data: bytes, *, label: str) -> Header:
    """Return the header of a BVH file; `BvhError` with the line where it is not legal."""
    parser = _Parser(data, label)
    skeleton = parser.shared_hierarchy() or parser.hierarchy()
    return parser.motion_lines(skeleton)


@lru_cache(maxsize=4)
def _shared_hierarchy(text: bytes) -> tuple[Skeleton, int]:
    """Return the skeleton of a text that ends with MOTION, and the byte after that word."""
    parser = _Parser(text, "")
    return parser.hierarchy(), parser.at


# The last such text, with what is returned of it: a file that begins with it need not be searched for the word.
_LAST: list[tuple[bytes, Skeleton, int]] = []


class _Parser:
    def __init__(self, data: bytes, label: str) -> None:
        self.data = data
        self.label = label
        self.at = 0  # the byte to read on from
        self.joints: list[_Joint] = []
        self.sites: list[EndSite] = []

    def refuse(self, message: str, at: int) -> NoReturn:
        raise refusal(self.data, message, label=self.label, at=at)

    def word(self) -> tuple[bytes, int]:
        """Return the next word or brace and its place, and move past it; b"" at the end of the file."""
        match = _WORD.match(self.data, self.at)
        if match is None:
            return b"", len(self.data.rstrip())
        word, at = match.group(1), match.start(1)
        self._refuse_endless(word, at)
        self.at = match.end()
        return word, at

    def _refuse_endless(self, word: bytes, at: int) -> None:
        if len(word) > WORD_LENGTH:
            self.refuse(f"{quoted(word)} is longer than {WORD_LENGTH} characters", at)

    def rest_of_line(self) -> bytes:
        """Return what stands up to a brace or the line's end, stripped, and move past it."""
        match = _REST_OF_LINE.match(self.data, self.at)
        assert match is not None  # noqa: S101 (the pattern matches the empty string)
        rest = match.group().strip()
        self._refuse_endless(rest, self.at)
        self.at = match.end()
        return rest

    def shared_hierarchy(self) -> Skeleton | None:
        """Return the skeleton by way of the last files', None where this file has to be parsed by itself."""
        for text, skeleton, end in _LAST:
            if self.data.startswith(text):
                self.at = end
                return skeleton
        motion = _MOTION.search(self.data, 0, _SHARED_BYTES)
        if motion is None:
            return None
        text = self.data[: motion.end()]
        try:
            skeleton, self.at = _shared_hierarchy(text)
        except BvhError:  # to be said with this file's name
            return None
        _LAST[:] = [(text, skeleton, self.at)]
        return skeleton

    def hierarchy(self) -> Skeleton:
        self._first_word()
        word, at = self.word()
        if word.lower() != b"root":
            self.refuse(f"expected ROOT after HIERARCHY, found {_shown(word)}", at)
        opened: list[_Joint] = []
        self._open(opened, word, at)
        while opened:
            word, at = self.word()
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
        word, at = self.word()
        if word.lower() != b"motion":
            self._refuse_after_root(word, at)
        if not any(joint.channels for joint in self.joints):
            self.refuse("the hierarchy has no channels, so no motion can be in this file", at)
        return self._skeleton()

    def _first_word(self) -> None:
        for mark, name in _BOMS.items():
            if self.data.startswith(mark):
                self.refuse(f"this is {name} text; save the file as UTF-8 or plain ASCII", 0)
        if self.data.startswith(_UTF8_BOM):
            self.at = len(_UTF8_BOM)
        word, at = self.word()
        if not word:
            self.refuse("the file is empty", 0)
        if b"\0" in word:
            self.refuse("NUL bytes: this is no text file (UTF-16 or binary); a BVH file is plain text", at)
        if word.lower() != b"hierarchy":
            self.refuse(f"expected HIERARCHY, found {quoted(word)}: not a BVH file", at)

    def _open(self, opened: list[_Joint], word: bytes, at: int) -> None:
        if opened and opened[-1].name is None:
            self.refuse(f"{text_of(word)} inside an End Site; an End Site holds only its OFFSET", at)
        rest = self.rest_of_line()
        parent = opened[-1].index if opened else -1
        if word.lower() == b"end":
            # "End Site" by the format; real files also number or name their ends, which says nothing.
            block = _Joint(None, -1, parent)
        else:
            if not rest:
                self.refuse(f"{text_of(word).upper()} without a name", at)
            if b"\0" in rest:
                self.refuse("NUL bytes in a joint's name: a BVH file is plain text", at)
            if len(self.joints) == MAX_JOINTS:
                self.refuse(f"more than {MAX_JOINTS} joints", at)
            block = _Joint(text_of(rest), len(self.joints), parent, shown=f"joint {quoted(rest)}")
            self.joints.append(block)
            if opened:
                opened[-1].has_child = True
        brace, place = self.word()
        if brace != b"{":
            where = place if brace else at
            self.refuse(f"expected '{{' after {block.shown}, found {_shown(brace)}", where)
        opened.append(block)

    def _offset(self, block: _Joint, at: int) -> None:
        if block.offset is not None:
            self.refuse(f"a second OFFSET in {block.shown}", at)
        words = self._words_of_statement(3, most=4)
        if len(words) != 3:
            self.refuse(f"OFFSET of {block.shown} has {_count(words)} values, it needs 3", at)
        values = [number(word) for word, _ in words]
        for (word, place), value in zip(words, values, strict=True):
            if value is None:
                self.refuse(f"OFFSET of {block.shown}: {quoted(word)} is not a finite number", place)
            if abs(value) > LARGEST_LENGTH:
                self.refuse(f"OFFSET of {block.shown}: {quoted(word)} is beyond any length", place)
        block.offset = frozen(np.array(values, dtype=np.float64))

    def _channels(self, block: _Joint, at: int) -> None:
        if block.name is None:
            self.refuse("CHANNELS inside an End Site; an End Site holds only its OFFSET", at)
        if block.channels is not None:
            self.refuse(f"a second CHANNELS in {block.shown}", at)
        if block.has_child:
            self.refuse(f"CHANNELS of {block.shown} stands after a child; it must stand before", at)
        counts = self._words_of_statement(1, most=1)
        if not counts:
            self.refuse(f"CHANNELS of {block.shown} has no count", at)
        counted, place = counts[0]
        if not _COUNT.fullmatch(counted) or int(counted) > 6:
            self.refuse(f"CHANNELS of {block.shown}: {quoted(counted)} is not a count from 0 to 6", place)
        words = self._words_of_statement(int(counted), most=7)
        names = []
        for word, place in words:
            name = _CHANNELS.get(word.lower())
            if name is None:
                self.refuse(f"{block.shown}: unknown channel {quoted(word)}", place)
            if name in names:
                self.refuse(f"{block.shown}: channel {name} is repeated", place)
            names.append(name)
        if len(names) != int(counted):
            self.refuse(f"{block.shown} says {int(counted)} channels and names {len(names)}", at)
        block.channels = tuple(names)

    def _words_of_statement(self, needed: int, *, most: int) -> list[tuple[bytes, int]]:
        """Return the words up to a keyword, a brace, or, once there are enough, the line's end."""
        words: list[tuple[bytes, int]] = []
        while len(words) < most:
            before = self.at
            word, at = self.word()
            another_line = _LINE_BREAK.search(self.data, before, at) is not None
            if not word or word in (b"{", b"}") or word.lower() in _KEYWORDS:
                self.at = before
                break
            if len(words) >= needed and another_line:
                self.at = before
                break
            words.append((word, at))
        return words

    def _close(self, block: _Joint, at: int) -> None:
        if block.offset is None:
            self.refuse(f"{block.shown} has no OFFSET", at)
        if block.name is None:
            self.sites.append(EndSite(block.parent, block.offset))

    def _refuse_word(self, word: bytes, at: int, opened: list[_Joint]) -> NoReturn:
        if not word:
            self.refuse(f"the file ends inside {opened[-1].shown}: {len(opened)} '}}' missing", at)
        if word.lower() == b"motion":
            self.refuse(f"MOTION inside {opened[-1].shown}: {len(opened)} '}}' missing", at)
        if word.lower() == b"root":
            self.refuse(f"a ROOT inside {opened[-1].shown}; only one ROOT can be read", at)
        self.refuse(
            f"expected OFFSET, CHANNELS, JOINT, End Site or '}}' in {opened[-1].shown}, found {quoted(word)}", at
        )

    def _refuse_after_root(self, word: bytes, at: int) -> NoReturn:
        if word.lower() == b"root":
            self.refuse("a second ROOT; only one skeleton a file can be read", at)
        if word == b"}":
            self.refuse("a '}' too many", at)
        if not word:
            self.refuse("the file ends before MOTION", at)
        self.refuse(f"expected MOTION after the hierarchy, found {quoted(word)}", at)

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

    def motion_lines(self, skeleton: Skeleton) -> Header:
        """Return the header, from the `Frames:` and `Frame Time:` lines after MOTION."""
        counted, frames_at = self._value_of(_FRAMES, "Frames:")
        if not counted:
            self.refuse("Frames: has no count", frames_at)
        if not _COUNT.fullmatch(counted):
            self.refuse(f"Frames: {quoted(counted)} is not a count of frames", frames_at)
        timed, time_at = self._value_of(_FRAME_TIME, "Frame Time:")
        if not timed:
            self.refuse("Frame Time: has no number", time_at)
        frame_time = number(timed)
        if frame_time is None:
            self.refuse(f"Frame Time: {quoted(timed)} is not a number", time_at)
        if frame_time <= 0.0:
            self.refuse(f"Frame Time: {text_of(timed)} is not positive", time_at)
        return Header(
            skeleton=skeleton,
            frames=int(counted),
            frame_time=frame_time,
            frames_span=(frames_at, frames_at + len(counted)),
            frame_time_span=(time_at, time_at + len(timed)),
            rows_start=self.at,
        )

    def _value_of(self, pattern: re.Pattern[bytes], key: str) -> tuple[bytes, int]:
        match = pattern.match(self.data, self.at)
        if match is None:
            word, at = self.word()
            self.refuse(f"expected '{key}' in the MOTION part, found {_shown(word)}", at)
        self.at = match.end()
        return match.group(2).rstrip(), match.start(2)


def _shown(word: bytes) -> str:
    return quoted(word) if word else "nothing"


def _count(words: list[tuple[bytes, int]]) -> str:
    return str(len(words)) if len(words) < 4 else "more than 3"
