"""The small faults that `make mutants` puts into files: operators, numbers, conditions changed, calls left out."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_PAIRS: list[tuple[type, type]] = [
    (ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq), (ast.Is, ast.IsNot), (ast.In, ast.NotIn),
    (ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.And, ast.Or), (ast.BitAnd, ast.BitOr),
]  # fmt: skip
_OTHER = {**dict(_PAIRS), **{other: one for one, other in _PAIRS}, ast.FloorDiv: ast.Mult, ast.Mod: ast.Add}

# In C: words between blanks, as the formatter leaves operators of two sides.
_C_OTHER = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
    "+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "+=",
}  # fmt: skip
_C_WORD = re.compile(r"(?<= )(?:[<>=!]=|[-+*]=|&&|\|\||[-+*/<>])(?= )|(?<![\w.])\d+(?:\.\d*)?(?![\w.])")
_C_QUIET = re.compile(r"/\*.*?\*/|\"(?:[^\"\\\n]|\\.)*\"|^[ \t]*#.*?$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Mutation:
    """A fault: the bytes from `start` to `stop`, on `line`, become `new`."""

    line: int
    start: int
    stop: int
    new: bytes

    def applied(self, text: bytes) -> bytes:
        """Return the file with the fault in it."""
        return text[: self.start] + self.new + text[self.stop :]

    def column(self, text: bytes) -> int:
        """Return where on its line it begins, from 1."""
        return self.start - text.rfind(b"\n", 0, self.start)

    def told(self, text: bytes) -> str:
        """Return what became what, on one line."""
        old = b" ".join(text[self.start : self.stop].split()).decode()
        return f"{old}  ->  {self.new.decode()}"


def mutations_of(text: bytes, *, name: str) -> list[Mutation]:
    """Return the faults that can be put into a file, in their order in it; its name tells Python from C."""
    found = in_python(text) if name.endswith(".py") else in_c(text)
    return sorted(found, key=lambda each: (each.start, each.stop, each.new))


def in_python(text: bytes) -> Iterator[Mutation]:
    """Yield the faults of a Python file: types, decorators and texts are left as they are."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for old, new in _changed(ast.parse(text)):
        start, stop = (starts[row - 1] + column for row, column in _ends(old))
        written = ast.unparse(new)
        yield Mutation(old.lineno, start, stop, (written if isinstance(new, ast.stmt) else f"({written})").encode())


def _ends(node: ast.AST) -> tuple[tuple[int, int], tuple[int, int]]:
    return (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)  # type: ignore[attr-defined]


def _changed(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Yield (a node, what stands in its place), through a tree."""
    if isinstance(node, ast.JoinedStr | ast.Import | ast.ImportFrom) or _for_types_alone(node):
        return
    yield from _instead(node)
    for name, child in ast.iter_fields(node):
        if name in {"annotation", "returns", "decorator_list"} or (
            isinstance(node, ast.keyword) and node.arg == "strict"
        ):
            continue
        for each in child if isinstance(child, list) else [child]:
            if isinstance(each, ast.AST):
                yield from _changed(each)


def _for_types_alone(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def _instead(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    match node:
        case ast.Compare(left, ops, comparators):
            for i, op in enumerate(ops):
                if type(op) in _OTHER:
                    yield node, ast.Compare(left, [*ops[:i], _OTHER[type(op)](), *ops[i + 1 :]], comparators)
        case ast.BinOp(left, op, right) if type(op) in _OTHER:
            yield node, ast.BinOp(left, _OTHER[type(op)](), right)
        case ast.BoolOp(op, values):
            yield node, ast.BoolOp(_OTHER[type(op)](), values)
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            yield node, operand
        case ast.Constant(bool() | int() | float() as value):
            yield node, ast.Constant(_other_value(value))
        case ast.AugAssign() | ast.Expr(ast.Call()):
            yield node, ast.Pass()
        case ast.If(test) | ast.IfExp(test) | ast.While(test) if isinstance(test, ast.Name | ast.Attribute | ast.Call):
            yield test, ast.UnaryOp(ast.Not(), test)


def _other_value(value: float) -> float:
    if isinstance(value, bool):
        return not value
    return value + 1 if isinstance(value, int) else 2.0 * value or 1.0


def in_c(text: bytes) -> Iterator[Mutation]:
    """Yield the faults of a C file: operators between blanks, and numbers."""
    shown = _C_QUIET.sub(lambda found: re.sub(r"[^\n]", "\0", found[0]), text.decode())
    for found in _C_WORD.finditer(shown):
        old = found[0]
        new = _C_OTHER.get(old) or (str(_other_value(float(old) if "." in old else int(old))))
        start = len(shown[: found.start()].encode())
        yield Mutation(shown.count("\n", 0, found.start()) + 1, start, start + len(old), new.encode())
