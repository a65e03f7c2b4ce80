"""The accuracy figures of golf swings of data/: reconstruction, edits at the hit, smoothness."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from data.generator.files import write_shipped
from motionedit.core.pca.model_file import read_model
from studies.figures_rows import HEADINGS, counts, goal_misses, row, side_effects, told
from studies.lab import DIRECTIONS, effector_path, largest_jerk

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from studies.lab import Lab

ROOT = Path(__file__).resolve().parents[1]
SWINGS = [ROOT / "data" / "golf" / f"swing{n:02d}.bvh" for n in range(1, 11)]
GOLF = {"events": {"hit": {"frames": str(ROOT / "data" / "golf" / "events.csv")}}}
EVENTS = (ROOT / "data" / "golf" / "events.csv").read_text().split()[1:]


def golf_goal(shift: FloatArray, **more: Any) -> dict[str, Any]:  # noqa: ANN401
    """Return an edit-pc spec that shifts the club head at the hit."""
    goal = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, "shift": list(map(float, shift))}
    return {"unit": "cm", "goals": [goal], **more}


def rebuilt(lab: Lab, clip: Path, model: Path, components: int) -> tuple[float, float]:
    """Return the club-head error (cm) of a swing rebuilt by its coefficients alone: at the hit, and over all frames."""
    common = {"timing": "normalized", "goals": [], "events": GOLF["events"]}
    plain = {**common, "residual": "drop", "components": components}
    ours, truth = (effector_path(lab.edit(clip, model, s).path, "Club", end_site=True) for s in (plain, common))
    errors = np.linalg.norm(ours - truth, axis=1)
    return float(errors[dict(read_model(model).timeline.events)["hit"]]), float(errors.mean())


def reconstruction(lab: Lab) -> list[tuple[str, ...]]:
    """In-sample and leave-one-out reconstruction."""
    model = lab.model(SWINGS, GOLF)
    rows: list[tuple[str, ...]] = [HEADINGS]
    # The normalized clips hold six decimals: what these cannot hold is not the model's.
    for count, aim in ((9, 1e-5), (8, 0.4), (5, 1.1)):
        hit, mean = np.mean([rebuilt(lab, clip, model, count) for clip in SWINGS], axis=0)
        rows.append(row(f"in the database, {count} components: at the hit, mean", hit, aim))
        rows.append(told(f"in the database, {count} components: all frames, mean", f"{mean:.3g}"))
    out = np.array([rebuilt(lab, clip, lab.model([c for c in SWINGS if c != clip], GOLF), 8) for clip in SWINGS])
    rows.append(row("left out: at the hit, mean", float(out[:, 0].mean()), 2.5))
    rows.append(told("left out: at the hit, worst clip", f"{out[:, 0].max():.3g}"))
    rows.append(told("left out: all frames, mean", f"{out[:, 1].mean():.3g}"))
    shares = read_model(model).components.explained_variance_ratio
    rows.append(row("share of the 9th component (%)", 100 * float(shares[8]), 1.0, least=True))
    rows.append(told("shares of the components (%)", " ".join(f"{100 * share:.1f}" for share in shares)))
    return rows


def golf_edits(lab: Lab) -> list[tuple[str, ...]]:
    """Edits of all ten swings."""
    model = lab.model(SWINGS, GOLF)
    return [HEADINGS, *_near(lab, model), *_far(lab, model)]


def _near(lab: Lab, model: Path) -> list[tuple[str, ...]]:
    """Return the figures of a ball that lies 10 cm elsewhere on the ground, and of one that lies where it is."""
    ground = [10.0 * np.array([np.sin(a), 0.0, np.cos(a)]) for a in np.linspace(0, 2 * np.pi, 8, endpoint=False)]
    near = [(clip, lab.edit(clip, model, golf_goal(shift)), shift) for clip in SWINGS for shift in ground]
    rows: list[tuple[str, ...]] = []
    rows.append(
        row(
            "10 cm on the ground: worst miss in the written file (mm)",
            float(goal_misses(near, "Club", end_site=True).max()),
            0.1,
        )
    )
    iterations = [edit.record["iterations"] for _, edit, _ in near]
    rows.append(row("10 cm: iterations, most", max(iterations), 12))
    rows.append(told("10 cm: iterations, median", f"{np.median(iterations):.0f}"))
    rows.append(told("10 cm: status", counts(near)))
    norms = [edit.record["change"]["norm"] / edit.record["change"]["bound"] for _, edit, _ in near]
    rows.append(row("10 cm: the change over its bound, worst", max(norms), 1.0))
    feet, jerks = side_effects(near)
    rows.append(row("10 cm: feet at the hit move, worst (cm)", max(feet), 6.0))
    rows.append(told("10 cm: feet at the hit move, median (cm)", f"{np.median(feet):.2f}"))
    rows.append(row("10 cm: whole-body jerk, output over input, worst", max(jerks), 2.0))
    still = lab.edit(SWINGS[3], model, golf_goal(np.zeros(3)))
    same = still.path.read_bytes() == SWINGS[3].read_bytes()
    rows.append(
        (
            "shift [0, 0, 0]",
            "the input's bytes" if same else "other bytes",
            "the input's bytes",
            "" if same else "MISSED",
        )
    )
    return rows


def _far(lab: Lab, model: Path) -> list[tuple[str, ...]]:
    """Return the figures of a ball that is further away than players reach, or higher or lower."""
    rows: list[tuple[str, ...]] = []
    far = [
        (clip, lab.edit(clip, model, golf_goal(35.0 * d, plausibility="off")), 35.0 * d)
        for clip in SWINGS
        for d in (DIRECTIONS[2], DIRECTIONS[5])
    ]
    rows.append(row("35 cm, no bound: worst miss (mm)", float(goal_misses(far, "Club", end_site=True).max()), 1.0))
    rows.append(row("35 cm, no bound: iterations, most", max(edit.record["iterations"] for _, edit, _ in far), 100))
    up = [
        (clip, lab.edit(clip, model, golf_goal(10.0 * d)), 10.0 * d)
        for clip in SWINGS
        for d in (DIRECTIONS[1], DIRECTIONS[4])
    ]
    rows.append(told("10 cm up or down: status", counts(up)))
    out = [
        (clip, lab.edit(clip, model, golf_goal(150.0 * d)), 150.0 * d)
        for clip in SWINGS
        for d in DIRECTIONS[[0, 2, 3, 5]]
    ]
    excess = [abs(edit.record["change"]["norm"] / edit.record["change"]["bound"] - 1.0) for _, edit, _ in out]
    rows += [told("150 cm: status", counts(out)), row("150 cm: the bound is kept to", max(excess), 1e-4)]
    _, jerks = side_effects(out)
    rows.append(row("150 cm: whole-body jerk, median", float(np.median(jerks)), 2.0))
    rows.append(row("150 cm: whole-body jerk, 95th percentile", float(np.percentile(jerks, 95)), 4.0))
    return rows


def smoothness(lab: Lab) -> list[tuple[str, ...]]:
    """Effector jerk of edits of clips finer than the timeline."""
    coarse, fine = lab.place(), lab.place()
    clips = [path for path in write_shipped(coarse, noise=0.0) if path.suffix == ".bvh" and path.parent.name == "golf"]
    model = lab.model(clips, GOLF)
    hits = {line.split(",")[0]: 120 / 25 * int(line.split(",")[1]) for line in EVENTS}
    ratios = []
    for clip in write_shipped(fine, noise=0.0, rate=120.0):
        if clip.suffix == ".bvh" and clip.parent.name == "golf":
            for shift in 10.0 * DIRECTIONS[[0, 2, 3, 5]]:
                edit = lab.edit(clip, model, golf_goal(shift, events={"hit": round(hits[clip.stem])}))
                before, after = (effector_path(path, "Club", end_site=True) for path in (clip, edit.path))
                ratios.append(largest_jerk(after) / largest_jerk(before))
    return [
        HEADINGS,
        row("largest third difference of the club head, median ratio", float(np.median(ratios)), 1.1),
        row("the same, worst ratio", max(ratios), 2.0),
    ]
