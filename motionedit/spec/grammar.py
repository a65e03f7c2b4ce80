r"""The patterns of numbers, names, times and orders in specs, from which parsers and the JSON Schema both come.

Editors read a schema's patterns as ECMAScript, where ``\w``, ``\d`` and ``\s`` are not what they are in Python, and
named groups are written otherwise. No pattern here has one of them, so that both read each alike.
"""

from itertools import permutations

INTEGER = "[0-9]+"
# A number without a sign: what a spec's plain numbers and the amounts of times have in common.
AMOUNT = rf"(?:{INTEGER}(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
# What Python takes for blanks.
BLANKS = r"[\t-\r\x1c- \x85\xa0\u1680\u2000-\u200a\u2028\u2029\u202f\u205f\u3000]*"

# All but signs and blanks is a letter, in whatever script.
_SIGNS = (
    r"\x00-/:-@\[-\^`{-\xa9\xab-\xb1\xb4\xb6-\xb8\xbb\xbf\xd7\xf7\u1680\u180e\u2000-\u206f\u20a0-\u20cf\u2190-\u245f"
    r"\u2500-\u2775\u2794-\u2bff\u2ff0-\u3004\u3008-\u3020\ue000-\uf8ff\ufe00-\ufe6f\ufeff\ufff0-\uffff"
)
_WORD = rf"(?![0-9])[^{_SIGNS}]+"
# A hyphen in an event's name is followed by a letter, so that ``hit-10`` can only be ten frames before ``hit``.
EVENT = rf"{_WORD}(?:-{_WORD})*"

# Groups: amount and unit; event, sign, amount and unit.
INSTANT = rf"({AMOUNT})(?:{BLANKS}([s%]))?"
FROM_EVENT = rf"({EVENT})(?:{BLANKS}([-+]){BLANKS}({AMOUNT})(?:{BLANKS}(s))?)?"
PLAIN_INSTANT = rf"{BLANKS}\+?{INSTANT}{BLANKS}"
TIME = rf"{BLANKS}(?:\+?{INSTANT}|{FROM_EVENT}){BLANKS}"
DURATION = rf"{BLANKS}\+?({AMOUNT})(?:{BLANKS}(s))?{BLANKS}"

# Euler orders as BVH channels name them, in letters of either size.
ORDERS = tuple("".join(order) for order in permutations("XYZ"))
ORDER = "|".join("".join(f"[{axis}{axis.lower()}]" for axis in order) for order in ORDERS)


def whole(pattern: str) -> str:
    """Return a schema's pattern for texts that are this from beginning to end."""
    # A plain $ also stands before a last line break, in Python.
    return rf"^(?:{pattern})(?![\s\S])"
