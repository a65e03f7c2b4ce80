"""Print the accuracy figures that the documentation quotes: golf swings of data/, and real strokes where they are.

Run it with `make figures`. The real clips are read from the folder that MOTIONEDIT_CLIPS names.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from data.generator.files import write_shipped
from motionedit.core.bvh import read_clip
from motionedit.core.pca.model_file import read_model
from studies import figures_prioritized
from studies.lab import DIRECTIONS, Lab, effector_path, jerk, joint_positions, largest_jerk, print_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from studies.lab import Edited

ROOT = Path(__file__).resolve().parents[1]
SWINGS = [ROOT / "data" / "golf" / f"swing{n:02d}.bvh" for n in range(1, 11)]
GOLF = {"events": {"hit": {"frames": str(ROOT / "data" / "golf" / "events.csv")}}}
EVENTS = (ROOT / "data" / "golf" / "events.csv").read_text().split()[1:]
HEADINGS = ("what", "measured", "aim", "")


def main() -> None:
    """Print every table."""
    with tempfile.TemporaryDirectory() as scratch:
        lab = Lab(Path(scratch))
        print_table("Golf: reconstruction of the club head (cm)", reconstruction(lab))
        print_table("Golf: edits at the hit", golf_edits(lab))
        print_table("Golf: smoothness, noise-free 120 Hz clips on a 25 Hz timeline", smoothness(lab))
        print_table(
            "Prioritized constraints: the demonstrations of [PRIO] on data/", figures_prioritized.demonstrations(lab)
        )
        print_table("Prioritized constraints: what holds of any edit", figures_prioritized.laws(lab))
        clips = os.environ.get("MOTIONEDIT_CLIPS")
        if clips is None or not Path(clips).is_dir():
            print("\nReal strokes: left out, MOTIONEDIT_CLIPS names no folder")
            return
        strokes = Path(clips) / "strokes"
        print_table("Real smashes (18 joints, 100 Hz), the clip left out of the database", smashes(lab, strokes))
        print_table("Real smashes cut at differing lengths from one take, left out", cut_smashes(lab, strokes))
        print_table("Real serves, the clip left out of the database", serves(lab, strokes))
        print_table("Real strokes brought to where another met the ball, both left out", to_others(lab, strokes))
        print_table("Prioritized constraints: the same on real clips", figures_prioritized.real(lab, Path(clips)))


def row(what: str, value: float, aim: float, *, least: bool = False) -> tuple[str, str, str, str]:
    """Return a line of a table: the figure beside its aim."""
    met = value >= aim if least else value <= aim
    return what, f"{value:.3g}", f"{'>=' if least else '<='} {aim:g}", "" if met else "MISSED"


def told(what: str, value: str) -> tuple[str, str, str, str]:
    """Return a line that has no aim."""
    return what, value, "", ""


# -- golf --------------------------------------------------------------------------------------------------------------


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


def goal_misses(edits: Sequence[tuple[Path, Edited, FloatArray]], joint: str, *, end_site: bool) -> FloatArray:
    """Return how far (mm at 1 cm units) each written file is from its goal: (clip, edit, shift) triples."""
    misses = []
    for clip, edit, shift in edits:
        frame = edit.record["goals"][0]["frame"]
        before = effector_path(clip, joint, end_site=end_site)[frame]
        after = effector_path(edit.path, joint, end_site=end_site)[frame]
        misses.append(10.0 * np.linalg.norm(after - before - shift))
    return np.array(misses)


def golf_edits(lab: Lab) -> list[tuple[str, ...]]:
    """Edits of all ten swings."""
    model = lab.model(SWINGS, GOLF)
    ground = [10.0 * np.array([np.sin(a), 0.0, np.cos(a)]) for a in np.linspace(0, 2 * np.pi, 8, endpoint=False)]
    near = [(clip, lab.edit(clip, model, golf_goal(shift)), shift) for clip in SWINGS for shift in ground]
    rows: list[tuple[str, ...]] = [HEADINGS]
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


def counts(edits: Sequence[tuple[Path, Edited, FloatArray]]) -> str:
    """Return how often each status came out."""
    found = [edit.record["status"] for _, edit, _ in edits]
    return ", ".join(f"{found.count(status)} {status}" for status in sorted(set(found)))


def side_effects(edits: Sequence[tuple[Path, Edited, FloatArray]]) -> tuple[list[float], list[float]]:
    """Return how far the feet move at the goal's frame, and the jerk over the input's, per edit."""
    feet, jerks = [], []
    for clip, edit, _ in edits:
        before, after = joint_positions(clip), joint_positions(edit.path)
        names = read_clip(clip).motion.skeleton.names
        soles = [j for j, name in enumerate(names) if name.endswith(("Foot", "ToeBase", "Ankle"))]
        frame = edit.record["goals"][0]["frame"]
        feet.append(float(np.linalg.norm(after[frame, soles] - before[frame, soles], axis=-1).max()))
        jerks.append(jerk(after) / jerk(before))
    return feet, jerks


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


# -- real strokes ------------------------------------------------------------------------------------------------------


def wrist_goal(shift: FloatArray, hit: int) -> dict[str, Any]:
    """Return an edit-pc spec that shifts the right wrist at the hit."""
    goal = {"name": "wrist", "at": "hit", "effector": "RightWrist", "shift": list(map(float, shift))}
    return {"unit": "cm", "events": {"hit": hit}, "goals": [goal]}


def left_out(
    lab: Lab, clips: Sequence[Path], hits: dict[str, int], directions: FloatArray
) -> list[tuple[Path, Edited, FloatArray]]:
    """Return 10 cm edits of every clip with a model of the others."""
    edits = []
    for clip in clips:
        others = [other for other in clips if other != clip]
        model = lab.model(others, {"events": {"hit": {"frames": {c.stem: hits[c.stem] for c in others}}}})
        edits += [(clip, lab.edit(clip, model, wrist_goal(10 * d, hits[clip.stem])), 10 * d) for d in directions]
    return edits


def stroke_rows(edits: Sequence[tuple[Path, Edited, FloatArray]]) -> list[tuple[str, ...]]:
    """Return the figures of 10 cm edits of real strokes."""
    jerks = [
        jerk(effector_path(edit.path, "RightWrist")) / jerk(effector_path(clip, "RightWrist"))
        for clip, edit, _ in edits
    ]
    norms = [edit.record["change"]["norm"] / edit.record["change"]["bound"] for _, edit, _ in edits]
    feet, _ = side_effects(edits)
    return [
        HEADINGS,
        row(
            "edits: worst miss in the written file (mm)",
            float(goal_misses(edits, "RightWrist", end_site=False).max()),
            0.1,
        ),
        row("iterations, most", max(edit.record["iterations"] for _, edit, _ in edits), 12),
        row("the change over its bound, worst", max(norms), 1.0),
        row("wrist jerk, output over input, median", float(np.median(jerks)), 1.1),
        row("wrist jerk, 95th percentile", float(np.percentile(jerks, 95)), 1.5),
        told("status", counts(edits)),
        row("feet at the hit move, median (cm)", float(np.median(feet)), 0.5),
    ]


def smashes(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit the eleven cut smashes in six directions each."""
    clips = sorted((strokes / "smash_mrios").glob("*.bvh"))
    return stroke_rows(left_out(lab, clips, {clip.stem: 110 for clip in clips}, DIRECTIONS))


def cut_smashes(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit the same smashes, cut from the whole take at lengths of our own."""
    take = read_clip(strokes / "takes" / "mrios_Remate.bvh")
    clips, hits = [], {}
    lines = (strokes / "events.tsv").read_text().splitlines()[1:]
    impacts = [int(line.split("\t")[2]) for line in lines if "smash_mrios" in line]
    for number, impact in enumerate(impacts):
        start = max(impact - 80 - 7 * (number % 4), 0)
        name = f"smash{number + 1:02d}"
        clips.append(lab.cut(take, start, impact + 50 + 6 * (number % 3), f"{name}.bvh"))
        hits[name] = impact - start
    return stroke_rows(left_out(lab, clips, hits, DIRECTIONS))


def serves(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit the eight serves, whose arm is stretched at the hit: up is the hard way."""
    clips = sorted((strokes / "serve_jsgiraldo").glob("*.bvh"))
    edits = left_out(lab, clips, {clip.stem: 140 for clip in clips}, DIRECTIONS)
    level = [edit for edit in edits if edit[2][1] == 0.0]
    up = [edit for edit in edits if edit[2][1] > 0.0]
    down = [edit for edit in edits if edit[2][1] < 0.0]
    return [
        HEADINGS,
        row("10 cm sideways: worst miss (mm)", float(goal_misses(level, "RightWrist", end_site=False).max()), 0.1),
        row("10 cm sideways: iterations, most", max(edit.record["iterations"] for _, edit, _ in level), 20),
        told("10 cm up: status", counts(up)),
        told("10 cm down: status", counts(down)),
    ]


def to_others(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit strokes to where another met the ball, and look how near to that stroke they come: below 1 is nearer."""
    rows: list[tuple[str, ...]] = [("strokes", "method", "edited over unedited", "further away", "feet (cm)")]
    for name, folder, hit in (("smash", "smash_mrios", 110), ("serve", "serve_jsgiraldo", 140)):
        clips = sorted((strokes / folder).glob("*.bvh"))
        for method, spec in (("map", {}), ("gauss-newton", {"solver": {"method": "gauss-newton"}})):
            found = [_to_other(lab, clips, i, (i + 3) % len(clips), hit, spec) for i in range(len(clips))]
            edited, unedited, feet = np.array(found).T
            ratio = np.sqrt(np.mean(edited**2) / np.mean(unedited**2))
            further = f"{np.count_nonzero(edited > unedited)} of {len(found)}"
            rows.append((name, method, f"{ratio:.3f}", further, f"{np.median(feet):.2f}"))
    return rows


def _to_other(
    lab: Lab, clips: Sequence[Path], one: int, other: int, hit: int, spec: dict[str, Any]
) -> tuple[float, float, float]:
    """Return the distance of an edited stroke to another, that of the unedited one, and how far its feet drift (cm).

    The hips of both are laid over each other at the hit.
    """
    rest = [clip for i, clip in enumerate(clips) if i not in {one, other}]
    model = lab.model(rest, {"events": {"hit": {"frames": {clip.stem: hit for clip in rest}}}})
    names = list(read_clip(clips[one]).motion.skeleton.names)
    wrist, hips = names.index("RightWrist"), [names.index("LeftHip"), names.index("RightHip")]
    own, theirs = (joint_positions(clips[i]) for i in (one, other))
    turn, origin = _by_hips(own[hit, hips])
    turn_there, origin_there = _by_hips(theirs[hit, hips])
    theirs = (theirs - origin_there) @ turn_there.T @ turn + origin
    goal = {"name": "contact", "at": hit, "effector": "RightWrist", "position": theirs[hit, wrist].tolist()}
    edit = lab.edit(clips[one], model, {"unit": "cm", "events": {"hit": hit}, "goals": [goal], **spec})
    near = slice(hit - 90, hit + 66)
    apart = [
        float(np.sqrt(np.mean(np.sum((body[near] - theirs[near]) ** 2, axis=-1))))
        for body in (joint_positions(edit.path), own)
    ]
    return apart[0], apart[1], float(edit.record["metrics"]["foot_drift_max"])


def _by_hips(hips: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the turn about y that brings the line of the hips onto x, and the point below their middle."""
    left = hips[0] - hips[1]
    angle = np.arctan2(left[2], left[0])
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return turn, hips.mean(axis=0) * np.array([1.0, 0.0, 1.0])


if __name__ == "__main__":
    main()
