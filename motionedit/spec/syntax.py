"""Why a text is no YAML: what either parser complains of, in plain words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.spec.faults import Fault

if TYPE_CHECKING:
    import yaml

# A spec has no use for more levels; libyaml refuses far more of them by itself, before it gives the first of them.
DEEPEST = 50
_TOO_DEEP = "maximum nesting depth"

# Parts of the parsers' messages (libyaml's and PyYAML's own) and what they mean to a person.
_SYNTAX = (
    (
        "mapping values are not allowed",
        "a second ': ' on the line, or a wrong indentation; quote a text that holds ': '",
    ),
    ("could not find expected ':'", "a key without ': ' after it"),
    ("while scanning a simple key", "a key without ': ' after it"),
    ("',' or ']'", "a list that is not closed; put ] at its end"),
    ("',' or '}'", "a mapping in braces that is not closed; put } at its end"),
    ("unexpected end of stream", "a quote that is not closed"),
    ("unknown escape character", "an unknown escape in double quotes; use single quotes"),
    ("expected node content", "a value that is not there"),
    ("expected the node content", "a value that is not there"),
    ("expected '-' indicator", "a line that does not fit the lines above; indent it as the lines it belongs to"),
    ("expected <block end>", "a line that does not fit the lines above; indent it as the lines it belongs to"),
    ("expected key", "a line that does not fit the lines above; indent it as the lines it belongs to"),
    ("cannot start any token", "a character that cannot begin a value; put quotes around the text"),
)


def syntax_fault(error: yaml.YAMLError, text: str) -> Fault:
    """Return what is wrong with a text that a parser refused, with its line."""
    mark = getattr(error, "problem_mark", None)
    if mark is None:
        # Only a character that YAML does not allow has no mark.
        position = getattr(error, "position", 0)
        line = text.count("\n", 0, position) + 1
        return Fault("not valid YAML: a control character; remove it", line=line)
    lines = text.splitlines()
    line = min(mark.line + 1, max(len(lines), 1))
    here = lines[line - 1] if lines else ""
    problem = f"{getattr(error, 'context', '')} {getattr(error, 'problem', '')}"
    if "\t" in here[: len(here) - len(here.lstrip())] or here[mark.column : mark.column + 1] == "\t":
        return Fault("not valid YAML: a tab; indent with blanks", line=line)
    if _TOO_DEEP in problem:
        return Fault(f"nested more than {DEEPEST} deep", line=line)
    context = getattr(error, "context_mark", None)
    if "',' or '}'" in problem and here[mark.column : mark.column + 1] == ":" and context and context.line == mark.line:
        return Fault("not valid YAML: a comma that is missing before a key in braces", line=line)
    opened = f" (opened on line {context.line + 1})" if context is not None and context.line + 1 < line else ""
    for part, meaning in _SYNTAX:
        if part in problem:
            return Fault(f"not valid YAML: {meaning}{opened if 'closed' in meaning else ''}", line=line)
    return Fault(f"not valid YAML: {getattr(error, 'problem', '') or 'it cannot be read'}", line=line)
