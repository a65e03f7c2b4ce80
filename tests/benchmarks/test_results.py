"""The README's figures of speed are those of the results that stand beside the benchmarks."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_the_readme_quotes_the_results():
    speed = (ROOT / "README.md").read_text().partition("## Speed")[2].partition("\n## ")[0]
    results = (ROOT / "benchmarks" / "results.md").read_text()
    figures = re.findall(r"\*\*([^*]+)\*\*", speed)
    assert len(figures) >= 7
    assert [figure for figure in figures if figure not in results] == []
