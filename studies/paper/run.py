"""Make the papers' tables and figures anew: `python -m studies.paper.run [STUDY ...]`, or `make paper` for all.

Pictures and tables.md go into --out. With --docs they also replace docs/images/paper-*.png and the blocks of
docs/papers.md; that needs the real clips, which are read from the folder that MOTIONEDIT_CLIPS names.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from studies.lab import Lab
from studies.paper import (
    pc_comparison,
    pc_convergence,
    pc_damping,
    pc_normalization,
    pc_pose_space,
    pc_strokes,
    pc_style,
    pc_truth,
    pc_variance,
    prio_balance,
    prio_karate,
    prio_reach_step,
    prio_stairs,
)
from studies.paper.drawing import png_bytes
from studies.paper.page import with_tables
from studies.paper.study import Study

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from studies.paper.study import Findings

ROOT = Path(__file__).resolve().parents[2]
STUDIES: dict[str, Callable[[Study], Findings]] = {
    "convergence": pc_convergence.study,
    "pose-space": pc_pose_space.study,
    "normalization": pc_normalization.study,
    "variance": pc_variance.study,
    "damping": pc_damping.study,
    "style": pc_style.study,
    "truth": pc_truth.study,
    "comparison": pc_comparison.study,
    "strokes": pc_strokes.study,
    "balance": prio_balance.study,
    "reach-step": prio_reach_step.study,
    "karate": prio_karate.study,
    "stairs": prio_stairs.study,
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Run studies, print their tables, write what they found."""
    options = _options(arguments)
    clips = _clips()
    if options.docs and clips is None:
        print("MOTIONEDIT_CLIPS names no folder of real clips: docs/ is left as it is", file=sys.stderr)
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        study = Study(Lab(Path(scratch)), clips=clips, quick=options.quick)
        for name in options.studies or STUDIES:
            _write(name, STUDIES[name](study), options.out, docs=options.docs and clips is not None)


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("studies", nargs="*", metavar="STUDY", help=", ".join(STUDIES))
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "paper", help="folder for pictures and tables.md")
    parser.add_argument("--docs", action="store_true", help="renew docs/papers.md and its pictures")
    parser.add_argument("--quick", action="store_true", help="few clips and goals, to see that all runs")
    options = parser.parse_args(arguments)
    if unknown := set(options.studies) - set(STUDIES):
        parser.error(f"no study {', '.join(sorted(unknown))}; there are {', '.join(STUDIES)}")
    return options


def _clips() -> Path | None:
    named = os.environ.get("MOTIONEDIT_CLIPS")
    return Path(named) if named is not None and Path(named).is_dir() else None


def _write(name: str, findings: Findings, out: Path, *, docs: bool) -> None:
    """Print and write what a study found; the tables of one study replace its own part of tables.md."""
    text = "\n\n".join(table.text for table in findings.tables)
    print(f"\n{text}", flush=True)
    (out / f"{name}.txt").write_text(text + "\n", encoding="utf-8")
    parts = [(study, out / f"{study}.txt") for study in STUDIES]
    sections = [f"## {s}\n\n```text\n{path.read_text(encoding='utf-8')}```\n" for s, path in parts if path.exists()]
    (out / "tables.md").write_text("\n".join(["# Tables\n", *sections]), encoding="utf-8")
    for picture, figure in findings.pictures.items():
        content = png_bytes(figure)
        (out / f"{picture}.png").write_bytes(content)
        if docs:
            (ROOT / "docs" / "images" / f"paper-{picture}.png").write_bytes(content)
    if docs:
        page = ROOT / "docs" / "papers.md"
        page.write_text(with_tables(page.read_text(encoding="utf-8"), findings.tables), encoding="utf-8")


if __name__ == "__main__":
    main()
