"""The made-up human of the unit tests stands in for a body here as well."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "unit" / "core"))
