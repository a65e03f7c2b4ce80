"""The clips of data/, read once, and where golfers, walkers and kickers have what is looked at."""

import numpy as np
import pytest

from motionedit.core.bvh import read_clip


@pytest.fixture(scope="module")
def folder(pytestconfig):
    return pytestconfig.rootpath / "data"


@pytest.fixture(scope="module")
def hits(folder):
    rows = (folder / "golf" / "events.csv").read_text().splitlines()
    assert rows[0] == "clip,frame"
    return {name: int(frame) for name, frame in (row.split(",") for row in rows[1:])}


@pytest.fixture(scope="module")
def balls(folder):
    rows = [row.split("\t") for row in (folder / "golf" / "balls.tsv").read_text().splitlines()[1:]]
    return {row[0]: np.array(row[2:], dtype=float) for row in rows}


@pytest.fixture(scope="module")
def swings(folder):
    return {path.stem: read_clip(path).motion for path in sorted((folder / "golf").glob("*.bvh"))}


@pytest.fixture(scope="module")
def walk(folder):
    return read_clip(folder / "walk.bvh").motion


@pytest.fixture(scope="module")
def kick(folder):
    return read_clip(folder / "kick.bvh").motion
