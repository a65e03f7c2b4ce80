"""[PC] eq. (8) against eq. (10), Figures 1 and 2: inverse kinematics in the space of poses, and of motions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.bvh import edited_bytes, read_clip
from motionedit.core.kinematics import Effector, forward
from motionedit.core.priorities.solver.points import Columns, Point, Recruited
from studies.lab import joint_positions
from studies.paper.drawing import BLUE, GREY, INK, ORANGE, Camera, Stage, body, new_figure
from studies.paper.study import ALGORITHM_1, Findings, Table, club_head, joint

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion
    from studies.paper.study import Study

SHOWN = 3
SHIFT = np.array([10.0, 0.0, 10.0])
_METRES = 0.01  # of a centimetre: the root's position counts in metres, as in a motion vector


@dataclass(frozen=True)
class PoseEdit:
    """A clip whose one frame was edited, and the iterations that it took."""

    path: Path
    iterations: int


def study(lab: Study) -> Findings:
    """Move the ball by eq. (8) and by eq. (10), and look at the frames beside the hit."""
    swings = (SHOWN,) if lab.quick else range(len(lab.swings))
    rows, shown = [], {}
    for swing in swings:
        single = by_poses(lab, swing, SHIFT, damping=10.0)
        whole = lab.edit(swing, {"shift": SHIFT.tolist()}, components=9, solver=ALGORITHM_1)
        rows.append(
            [
                [single.iterations, *_damage(lab, swing, single.path)],
                [whole.record["iterations"], *_damage(lab, swing, whole.path)],
            ]
        )
        if swing == SHOWN:
            shown = {"eq. (8)": single.path, "eq. (10)": whole.path}
    return Findings((_sizes(lab), _table(np.median(rows, axis=0))), {"pc-pose-space": _figure(lab, shown)})


def by_poses(lab: Study, swing: int, shift: FloatArray, *, damping: float) -> PoseEdit:
    """Edit the hit alone: dTheta = J^T (J J^T + xi^2 I)^-1 dx over all joints to the club and the root, eq. (8)."""
    clip = read_clip(lab.swings[swing])
    motion, hit = clip.motion, lab.hits[swing]
    skeleton = motion.skeleton
    club = skeleton.names.index("Club")
    tip = Effector(club, next(site.offset for site in skeleton.end_sites if site.joint == club))
    chain = skeleton.chain(club)
    pose = replace(motion, rotations=motion.rotations[hit : hit + 1], translations=motion.translations[hit : hit + 1])
    point = Point(Columns(skeleton, chain, 0), tip, Recruited(np.ones(len(chain), dtype=np.bool_), root=True))
    goal = point.position(forward(pose))[0] + shift
    iterations = 0
    while np.linalg.norm(error := goal - point.position(forward(pose))[0]) >= 1.0:
        rows = point.position_rows(forward(pose))[0]
        J = np.hstack((rows[:, -3:] / _METRES, rows[:, :-3]))
        step = J.T @ np.linalg.solve(J @ J.T + damping**2 * np.eye(3), error)
        pose = _stepped(pose, chain, step[:3] / _METRES, step[3:].reshape(-1, 3))
        iterations += 1
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[hit], translations[hit] = pose.rotations[0], pose.translations[0]
    touched, moved = np.zeros(rotations.shape[:2], dtype=bool), np.zeros(translations.shape[:2], dtype=bool)
    touched[hit], moved[hit] = True, True
    path = lab.lab.place() / lab.swings[swing].name
    path.write_bytes(
        edited_bytes(
            clip, replace(motion, rotations=rotations, translations=translations), touched=touched, moved=moved
        )
    )
    return PoseEdit(path, iterations)


def _stepped(pose: Motion, chain: IntArray, move: FloatArray, turns: FloatArray) -> Motion:
    """Return a pose of one frame with the root moved and joints turned by world-axis increments."""
    world, parents = forward(pose).rotations[0], pose.skeleton.parents
    rotations, translations = pose.rotations.copy(), pose.translations.copy()
    translations[0, 0] += move
    for j, turn in zip(chain, turns, strict=True):
        local = rot.rotate(rot.conjugate(world[parents[j]]), turn) if parents[j] >= 0 else turn
        rotations[0, j] = rot.multiply(rot.exp(local), rotations[0, j])
    return replace(pose, rotations=rotations, translations=translations)


def _damage(lab: Study, swing: int, path: Path) -> tuple[float, ...]:
    """Return cm: break of the club's path at the hit, how far the feet move there, the left hand along the grip."""
    hit, source = lab.hits[swing], lab.swings[swing]
    before, after = joint_positions(source), joint_positions(path)
    added = club_head(path) - club_head(source)
    # How far the hit's displacement is from half way between those of the frames beside it.
    broken = np.linalg.norm(added[hit] - 0.5 * (added[hit - 1] + added[hit + 1]))
    feet = [joint(source, f"{side}{part}") for side in ("Left", "Right") for part in ("Foot", "ToeBase")]
    hand, club = joint(source, "LeftHand"), joint(source, "Club")
    apart = [np.linalg.norm(p[hit, hand] - p[hit, club]) for p in (before, after)]
    slid = np.linalg.norm(after[hit, feet] - before[hit, feet], axis=-1).max()
    return float(broken), float(slid), float(abs(apart[1] - apart[0]))


def _sizes(lab: Study) -> Table:
    n, frames = lab.model.space.size, lab.model.timeline.frames
    m = len(lab.model.components.explained_variance)
    rows: list[tuple[str, ...]] = [
        ("matrix", "the paper", "ours"),
        ("J(Theta), p x n", "3 x 93", f"3 x {n}"),
        ("J(E) at t_k, n x m", "93 x 9", f"{n} x {m}"),
        ("J(alpha), p x m", "3 x 9", f"3 x {m}"),
        ("the basis, D x m", "12276 x 9", f"{n * frames} x {m}"),
    ]
    return Table("pc-sizes", "Figure 1: sizes of the matrices", tuple(rows))


def _table(medians: FloatArray) -> Table:
    what = (
        ("iterations", ".0f"),
        ("break of the club's path at the hit (cm)", ".2f"),
        ("feet move at the hit (cm)", ".2f"),
        ("left hand moves on the grip (cm)", ".2f"),
    )
    rows: list[tuple[str, ...]] = [("xi = 10, until 1 cm", "eq. (8), poses", "eq. (10), motions")]
    rows += [(name, *(f"{value:{form}}" for value in medians[:, i])) for i, (name, form) in enumerate(what)]
    title = "The ball moved by 14 cm (10 ahead, 10 away): inverse kinematics at the hit, medians of ten swings"
    return Table("pc-pose-space", title, tuple(rows))


def _figure(lab: Study, shown: dict[str, Path]) -> Figure:
    figure = new_figure(10.0, 3.5)
    left, right = figure.subfigures(1, 2, width_ratios=(2.2, 1.0))
    stage, hit, source = Stage(left.subplots(), Camera(28.0, 10.0)), lab.hits[SHOWN], body(lab.swings[SHOWN])
    goal, anchor = club_head(lab.swings[SHOWN])[hit] + SHIFT, np.zeros(3)
    kinds = {"the input": (lab.swings[SHOWN], GREY), "eq. (10), motions": (shown["eq. (10)"], ORANGE)}
    kinds["eq. (8), poses"] = (shown["eq. (8)"], BLUE)
    for place, (path, color) in enumerate(kinds.values()):
        at = 150.0 * place
        stage.floor(anchor + np.array([10.0, 0.0, 30.0]), at, half=(60.0, 60.0), step=30.0)
        if place:
            stage.pose(source, hit, GREY, anchor=anchor, at=at, alpha=0.4)
        stage.pose(body(path), hit, color, anchor=anchor, at=at)
        stage.mark(goal, "o", "#ffffff", anchor=anchor, at=at)
    for place, name in enumerate(kinds):
        stage.text(name, 150.0 * place)
    stage.close(margin=10.0)
    _displacements(right.subplots(), lab, shown)
    return figure


def _displacements(axes: Axes, lab: Study, shown: dict[str, Path]) -> None:
    hit, source = lab.hits[SHOWN], club_head(lab.swings[SHOWN])
    frames = np.arange(hit - 12, hit + 13)
    for (name, path), color in zip(shown.items(), (BLUE, ORANGE), strict=True):
        moved = np.linalg.norm(club_head(path) - source, axis=1)
        axes.plot(frames - hit, moved[frames], "o-", color=color, markersize=3, label=name)
    axes.axvline(0.0, color=INK, linewidth=0.8, linestyle=":")
    axes.set_xlabel("frames from the hit")
    axes.set_ylabel("club head moved by (cm)")
    axes.set_title("Beside the hit")
    axes.legend(loc="upper right")
