"""The scripts of benchmarks/, those that run without a peer."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# At the end: their short names shall hide nothing.
sys.path += [str(ROOT / "benchmarks"), str(ROOT / "benchmarks" / "peers")]
