"""The same program as the command `motionedit`, for `python -m motionedit`."""

from motionedit.cli import main

main()
