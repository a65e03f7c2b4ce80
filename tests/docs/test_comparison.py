"""What the page on other tools says stands in the page of results."""

import re

BOLD = re.compile(r"\*\*(.+?)\*\*", re.DOTALL)


def test_figures_of_the_comparison_stand_in_the_results(root):
    results = (root / "benchmarks" / "peers.md").read_text(encoding="utf-8")
    cells = {cell.strip() for line in results.splitlines() for cell in line.split("|")}
    page = (root / "docs" / "comparison.md").read_text(encoding="utf-8")
    figures = {" ".join(text.split()) for text in BOLD.findall(page) if re.search(r"\d", text)}
    assert figures
    assert figures <= cells
