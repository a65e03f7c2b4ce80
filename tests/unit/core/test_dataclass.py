"""Quick frozen dataclasses are those of the library in all but the time they take."""

import inspect
import pickle
import threading
from dataclasses import FrozenInstanceError, dataclass, field, fields, replace
from functools import cached_property

import pytest

from motionedit import dataclass as quick

MAKERS = pytest.mark.parametrize("make", [dataclass, quick.dataclass], ids=["library", "ours"])


def made(make, *, eq=True):
    @make(frozen=True, eq=eq)
    class Point:
        """A point."""

        x: int
        y: list = field(default_factory=list)
        note: str = field(default="", compare=False)

        @cached_property
        def double(self):
            return 2 * self.x

    return Point


@quick.dataclass(frozen=True)
class Sent:
    """What goes from process to process."""

    name: str


@MAKERS
def test_it_is_frozen(make):
    point = made(make)(1)
    for change in (lambda: setattr(point, "x", 2), lambda: setattr(point, "z", 2), lambda: delattr(point, "x")):
        with pytest.raises(FrozenInstanceError):
            change()
    assert point.x == 1
    assert point.double == 2
    assert replace(point, x=3).double == 6
    assert [each.name for each in fields(point)] == ["x", "y", "note"]


@MAKERS
def test_it_shows_and_compares_its_fields(make):
    Point = made(make)
    assert repr(Point(1, note="a")).endswith("Point(x=1, y=[], note='a')")
    assert Point(1, [2], "a") == Point(1, [2], "b") != Point(1, [3])
    assert Point(1) != 1
    assert hash(Point(1, (2,), "a")) == hash(Point(1, (2,), "b"))


@MAKERS
def test_without_eq_it_is_itself_alone(make):
    Point = made(make, eq=False)
    point = Point(1)
    assert point != Point(1)
    assert len({point, point, Point(1)}) == 2


def test_it_goes_through_a_pickle():
    assert pickle.loads(pickle.dumps(Sent("a"))) == Sent("a")  # noqa: S301  its own


def test_a_hash_is_kept_and_sent_to_no_other_process():
    sent = Sent("a")
    before = pickle.dumps(sent)
    assert hash(sent) == hash(sent) == hash(Sent("a"))
    assert pickle.dumps(sent) == before


def test_a_copy_with_other_fields_keeps_nothing_that_was_found_of_the_first():
    point = made(quick.dataclass)(1, (2,), "a")
    assert (point.double, hash(point)) == (2, hash(point))
    copy = quick.replace(point, x=3)
    assert (copy.x, copy.y, copy.note, copy.double) == (3, (2,), "a", 6)
    assert hash(copy) != hash(point)
    assert type(copy) is type(point)
    assert point.x == 1


ASKED_FIRST = {
    "made": lambda cls: cls([1]).y,
    "fields": fields,
    "signature": inspect.signature,
    "subclass": lambda cls: cls.sub([1], note="a"),
    "threads": lambda cls: [each.join() for each in [start(cls, [1]) for _ in range(8)]],
}


def start(cls, value):
    thread = threading.Thread(target=cls, args=(value,))
    thread.start()
    return thread


@MAKERS
@pytest.mark.parametrize("ask", ASKED_FIRST.values(), ids=ASKED_FIRST)
def test_it_is_the_same_whatever_it_is_asked_for_first(make, ask):
    @make(frozen=True)
    class Point:
        y: list = field(default_factory=list)

    @make(frozen=True)
    class Sub(Point):
        note: str = ""

    Point.sub = Sub
    ask(Point)
    assert [each.name for each in fields(Sub)] == ["y", "note"]
    assert list(inspect.signature(Sub).parameters) == ["y", "note"]
    assert Sub() == Sub([], "")
    assert Sub().y is not Sub().y
    assert inspect.getdoc(Sub)
