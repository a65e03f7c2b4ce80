"""Damage as disks, editors and other programs do it, to bytes and to plain values, as strategies of hypothesis."""

import copy
import re

from hypothesis import strategies as st

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NUMBERS = [
    *(b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e-308", b"1e9", b"1e10", b"-1", b"0", b"-0.0", b"1e400"),
    *(
        b"180",
        b"-90",
        b"1000",
        b"0.001",
        b"1e-5",
        b"99999999999999999999",
        b"0x10",
        b"1_000",
        b"010",
        b"1:30",
        b"2e",
        b"--1",
        b".",
        b"3,5",
        b"\xd9\xa3",
    ),
]
VALUES = st.sampled_from(
    [
        *(None, True, False, 0, -1, 1, 3, 10**30, 0.0, -0.0, 0.5, 1e9, 1e10, 1e308, 5e-324),
        *(
            float("nan"),
            float("inf"),
            float("-inf"),
            "",
            "x",
            "Hips",
            "\0",
            "\x1b[2J",
            "é" * 9,
            "1e3",
            "off",
            "</script>",
        ),
        *([], [None], [1, 2, 3], [[1, 2], [3]], {}, {"x": 1}, {"joint": "Hips", "offset": [0, 0, 0]}),
    ]
)


@st.composite
def damaged_bytes(draw, seeds, words):
    """Return one of some files after a few accidents; `words` are what such a file is made of."""
    data = draw(st.sampled_from(seeds))
    for _ in range(draw(st.integers(1, 4))):
        accident = draw(st.sampled_from(["cut", "again", "word", "number", "number", "byte", "end"]))
        start = draw(st.integers(0, len(data)))
        stop = min(start + draw(st.integers(1, 80)), len(data))
        if accident == "cut":
            data = data[:start] + data[stop:]
        elif accident == "again":
            at = draw(st.integers(0, len(data)))
            data = data[:at] + data[start:stop] + data[at:]
        elif accident == "word":
            data = data[:start] + draw(st.sampled_from(words)) + data[start:]
        elif accident == "byte":
            data = data[:start] + draw(st.binary(min_size=1, max_size=2)) + data[stop:]
        elif accident == "end":
            data = data[:start]
        elif numbers := list(NUMBER.finditer(data)):
            found = draw(st.sampled_from(numbers))
            data = data[: found.start()] + draw(st.sampled_from(NUMBERS)) + data[found.end() :]
    return data


@st.composite
def damaged_values(draw, data):
    """Return plain data of which a few values are replaced, left out, moved or named otherwise."""
    data = copy.deepcopy(data)
    for _ in range(draw(st.sampled_from([1, 1, 2, 3]))):
        found = list(places(data))
        if not found:
            break
        container, key = draw(st.sampled_from(found))
        change = draw(st.sampled_from(["replace", "remove", "swap", "rename", "scale", "scale"]))
        if change == "scale" and type(container[key]) in {int, float}:
            container[key] *= draw(st.sampled_from([-1, 0, 0.5, 2, 7, 1000, 1e-6, 1e6]))
        elif change in {"replace", "scale"}:
            container[key] = copy.deepcopy(draw(VALUES))
        elif change == "remove":
            del container[key]
        elif change == "swap":
            other, place = draw(st.sampled_from(found))
            container[key] = copy.deepcopy(other[place])
        elif isinstance(container, dict):
            container[draw(st.sampled_from(["", "x", "clips", "at", "schema"]))] = container.pop(key)
    return data


def places(data):
    """Yield every container of plain data with each of its keys."""
    for key, value in list(data.items() if isinstance(data, dict) else enumerate(data)):
        yield data, key
        if isinstance(value, (dict, list)):
            yield from places(value)
