"""[PC] Figure 5: how much of the database the components hold, and how well they rebuild a motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.pca.model_file import read_model
from studies.paper.drawing import BLUE, GREEN, ORANGE, PURPLE, new_figure
from studies.paper.study import GOLF, Findings, Table, club_head

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from studies.paper.study import Study


def study(lab: Study) -> Findings:
    """Print shares of the variance, and rebuild swings in and out of the database by two to nine components."""
    shares = 100.0 * lab.model.components.explained_variance_ratio
    counts = (2, 5, 9) if lab.quick else tuple(range(1, 10))
    chosen = range(2) if lab.quick else range(len(lab.swings))
    inside = {m: [_error(lab, s, lab.model_path, m) for s in chosen] for m in counts}
    models = {s: lab.lab.model([c for i, c in enumerate(lab.swings) if i != s], GOLF) for s in chosen}
    outside = {m: [_error(lab, s, models[s], m) for s in chosen] for m in counts if m < len(shares)}
    sigma = {"golf, data/": np.cumsum(shares), **_real_shares(lab)}
    return Findings(
        (_table(shares, inside, outside), *_real_table(sigma)), {"pc-variance": _figure(sigma, inside, outside)}
    )


def _error(lab: Study, swing: int, model: Path, components: int) -> tuple[float, float]:
    """Return the club head's error (cm) of eq. (3) alone, on the timeline: at the hit, and over all frames."""
    common: dict[str, Any] = {"goals": [], "timing": "normalized", **GOLF}
    rebuilt, truth = (
        club_head(lab.lab.edit(lab.swings[swing], model, spec).path)
        for spec in ({**common, "residual": "drop", "components": components}, common)
    )
    errors = np.linalg.norm(rebuilt - truth, axis=1)
    return float(errors[dict(read_model(model).timeline.events)["hit"]]), float(errors.mean())


def _table(
    shares: FloatArray, inside: dict[int, list[tuple[float, float]]], outside: dict[int, list[tuple[float, float]]]
) -> Table:
    rows: list[tuple[str, ...]] = [
        ("components", "share (%)", "sigma (%)", "in it: hit", "all", "left out: hit", "all")
    ]
    sigma = np.cumsum(shares)
    for m, errors in inside.items():
        cells = [f"{value:.2f}" for value in np.mean(errors, axis=0)]
        cells += [f"{value:.2f}" for value in np.mean(outside[m], axis=0)] if m in outside else ["", ""]
        rows.append((str(m), f"{shares[m - 1]:.1f}", f"{sigma[m - 1]:.1f}", *cells))
    title = "Figure 5: sigma of eq. (4), and the club head's mean error (cm) when eq. (3) rebuilds a swing"
    return Table("pc-variance", title, tuple(rows))


def _real_shares(lab: Study) -> dict[str, FloatArray]:
    """Return sigma of the databases of real strokes."""
    if lab.clips is None or lab.quick:
        return {}
    found = {}
    for name, folder, hit in (("smash, 11 real", "smash_mrios", 110), ("serve, 8 real", "serve_jsgiraldo", 140)):
        clips = sorted((lab.clips / "strokes" / folder).glob("*.bvh"))
        if len(clips) > 2:
            model = lab.lab.model(clips, {"events": {"hit": {"frames": {clip.stem: hit for clip in clips}}}})
            found[name] = 100.0 * np.cumsum(read_model(model).components.explained_variance_ratio)
    return found


def _real_table(sigma: dict[str, FloatArray]) -> tuple[Table, ...]:
    if len(sigma) < 2:
        return ()
    most = max(len(values) for values in sigma.values())
    rows: list[tuple[str, ...]] = [("database", *(str(m) for m in range(1, most + 1)))]
    for name, values in sigma.items():
        rows.append((name, *(f"{v:.1f}" for v in values), *[""] * (most - len(values))))
    return (Table("pc-variance-real", "sigma (%) by components", tuple(rows), quoted=True),)


def _figure(
    sigma: dict[str, FloatArray],
    inside: dict[int, list[tuple[float, float]]],
    outside: dict[int, list[tuple[float, float]]],
) -> Figure:
    figure = new_figure(10.0, 3.2)
    left, right = figure.subplots(1, 2)
    for (name, values), color in zip(sigma.items(), (ORANGE, BLUE, GREEN), strict=False):
        left.plot(np.arange(1, len(values) + 1), values, "o-", color=color, markersize=4, label=name)
    left.set_title("Figure 5: percentage of the database")
    left.set_xlabel("components")
    left.set_ylabel("sigma (%)")
    left.set_ylim(30.0, 102.0)
    left.legend(loc="lower right")
    for errors, color, words in ((inside, ORANGE, "in the database"), (outside, PURPLE, "left out of it")):
        means = np.array([np.mean(errors[m], axis=0) for m in errors])
        right.plot(list(errors), means[:, 0], "o-", color=color, markersize=4, label=f"{words}, at the hit")
        right.plot(list(errors), means[:, 1], "o--", color=color, markersize=3, linewidth=1.0, label="all frames")
    right.set_title("Club head of a rebuilt swing")
    right.set_xlabel("components")
    right.set_ylabel("mean error (cm)")
    right.set_ylim(-0.5, 17.5)
    right.legend(loc="upper right", ncols=2)
    return figure
