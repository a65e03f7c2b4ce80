"""The edit by motion principal coefficients, from one iteration to the whole process."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from benchmarks.clock import Row, at_most, best_of, longer, process
from motionedit.core.coefficients import edit as coefficient_edit
from motionedit.core.coefficients.goals import stacked_errors
from motionedit.core.coefficients.likeliest import likeliest_change
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.edit_pc import job as edit_pc
from motionedit.spec.load import load_spec
from studies.lab import Lab

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.coefficients.goals import Goal
    from motionedit.core.coefficients.likeliest import LikeliestChange

ROOT = Path(__file__).resolve().parents[1]
CLIP = ROOT / "data" / "golf" / "swing04.bvh"
MICROSECONDS, MILLISECONDS = 1e-6, 1e-3


def rows(folder: Path) -> list[Row]:
    """Return the table's rows on edit-pc and on the start of the program."""
    lab = Lab(folder / "lab")
    configs = {name: ROOT / "configs" / f"golf-{name}.yaml" for name in ("normalize", "edit")}
    normalize = yaml.safe_load(configs["normalize"].read_text())
    normalize["events"]["hit"]["frames"] = str(ROOT / "data" / "golf" / "events.csv")
    model = lab.model(sorted((ROOT / "data" / "golf").glob("*.bvh")), normalize)
    return [*_solver_rows(lab, model), *_process_rows(folder, model, configs["edit"])]


def _solver_rows(lab: Lab, model: Path) -> list[Row]:
    near, near_settings, met = _problem(lab, model, [0, 0, 10])
    far, far_settings, unmet = _problem(lab, model, [150, 0, 0])
    spec = load_spec(_spec(lab, [0, 0, 10]), "edit-pc")
    out = str(lab.place() / "edited.bvh")
    best = best_of(
        {
            "iteration": lambda: stacked_errors(near[0], met.change),
            "solve": lambda: likeliest_change(near, **near_settings),
            "bounded": lambda: likeliest_change(far, **far_settings),
            "edit": lambda: edit_pc.run(spec, [CLIP], out, model, RunOptions()),
        },
        rounds=5,
    )
    joints = len(near[0][0].chain.vectors)
    return [
        at_most(f"edit-pc: error and Jacobian, {joints} joints in the chain", best["iteration"], 100 * MICROSECONDS),
        at_most(f"edit-pc: solve, 10 cm, {met.iterations} iterations", best["solve"], MILLISECONDS),
        at_most(f"edit-pc: solve, 150 cm, ends at the {unmet.reason}", best["bounded"], 200 * MILLISECONDS),
        at_most("edit-pc: clip in, clip out, inside a process", best["edit"], None),
    ]


def _spec(lab: Lab, shift: Sequence[float]) -> Path:
    goal = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, "shift": list(shift)}
    path = lab.place() / "spec.yaml"
    path.write_text(yaml.safe_dump({"schema": "motionedit/edit-pc/v1", "unit": "cm", "goals": [goal]}))
    return path


def _problem(
    lab: Lab, model: Path, shift: Sequence[float]
) -> tuple[Sequence[Sequence[Goal]], dict[str, Any], LikeliestChange]:
    """Return what the edit of a clip gives its solver, and what the solver finds."""
    found: list[tuple[Sequence[Sequence[Goal]], dict[str, Any], LikeliestChange]] = []

    def noted(layers: Sequence[Sequence[Goal]], **settings: Any) -> LikeliestChange:  # noqa: ANN401  as the solver's own
        found.append((layers, settings, likeliest_change(layers, **settings)))
        return found[-1][-1]

    coefficient_edit.likeliest_change = noted
    try:
        edit_pc.run(load_spec(_spec(lab, shift), "edit-pc"), [CLIP], str(lab.place()), model, RunOptions())
    finally:
        coefficient_edit.likeliest_change = likeliest_change
    return found[0]


def _process_rows(folder: Path, model: Path, spec: Path) -> list[Row]:
    python, program = sys.executable, Path(sys.executable).parent / "motionedit"
    edit = (program, "edit-pc", CLIP, "-m", model, "-s", spec, "-o", folder / "edited.bvh")
    runs: dict[str, Callable[[], object]] = {
        "edit": process(edit, folder),
        "libraries": process((python, "-c", "import numpy, click, yaml"), folder),
        "help": process((program, "--help"), folder),
        "click": process((python, "-c", "import click"), folder),
    }
    for run in runs.values():  # compiled modules are written, files are in memory
        run()
    best = best_of(runs, rounds=8)
    return [
        longer(
            "motionedit edit-pc, a process, file to file",
            best["edit"],
            best["libraries"],
            aim=3.0,
            than="import numpy, click, yaml",
        ),
        longer("motionedit --help, a process", best["help"], best["click"], aim=1.5, than="import click"),
    ]
