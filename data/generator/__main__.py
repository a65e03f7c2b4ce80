"""The generator's command line: `python -m data.generator` writes the shipped clips anew."""

from __future__ import annotations

import argparse
from pathlib import Path

from data.generator.compare import comparison
from data.generator.files import write_shipped
from data.generator.players import SHIPPED_RATE


def main() -> None:
    """Parse, write, print the paths."""
    parser = argparse.ArgumentParser(prog="python -m data.generator", description=main.__doc__)
    here = Path(__file__).resolve().parents[1]
    parser.add_argument("--out", type=Path, default=here, help="folder to write to (default: data/)")
    parser.add_argument("--noise", type=float, default=1.0, help="scale of the golfers' noise (default 1)")
    parser.add_argument("--rate", type=float, default=SHIPPED_RATE, help="Hz of the golf clips (default 25)")
    parser.add_argument("--compare", type=Path, metavar="FOLDER", help="measure real clips beside ours, write nothing")
    options = parser.parse_args()
    if options.compare is not None:
        print(comparison(options.compare), end="")
        return
    for path in write_shipped(options.out, noise=options.noise, rate=options.rate):
        print(path)


if __name__ == "__main__":
    main()
