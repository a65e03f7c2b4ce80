"""A small legal BVH file whose parts tests replace."""

HIERARCHY = """\
HIERARCHY
ROOT Hips
{
\tOFFSET 0.0 0.0 0.0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT Spine
\t{
\t\tOFFSET 0.0 10.5 -1e-1
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0.0 5.0 0.0
\t\t}
\t}
}
"""
ROWS = "1 2 3 10.5 -20.25 30 4 5 6\n1.5 2 3 11 -21 31 4 5 6\n2 2 3 12 -22.125 32 4 5 6\n"
MOTION = f"MOTION\nFrames: 3\nFrame Time: 0.04\n{ROWS}"
TEXT = HIERARCHY + MOTION
FIRST_ROW_LINE = TEXT.count("\n") - 2


def with_text(old: str, new: str) -> bytes:
    """Return the small clip with one piece of its text, which must be there, replaced."""
    assert old in TEXT
    return TEXT.replace(old, new, 1).encode()
