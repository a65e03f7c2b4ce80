"""Every spec in configs/ runs as its own first lines say, on the clips in data/."""

import json
import os
import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from motionedit.cli import main
from motionedit.core.bvh import read_clip

ROOT = Path(__file__).resolve().parents[2]
CONFIGS = sorted((ROOT / "configs").glob("*.yaml"))
# What others build on comes first.
FIRST = ["golf-normalize.yaml", "golf-fit.yaml", "stroke-normalize.yaml"]
LINE = re.compile(r"^#   (motionedit .*)$", re.MULTILINE)
SMASHES = Path(os.environ.get("MOTIONEDIT_CLIPS", "/nowhere")) / "strokes" / "smash_mrios"


def run(line, folder):
    before = Path.cwd()
    os.chdir(folder)
    try:
        result = CliRunner().invoke(main, shlex.split(line)[1:])
    finally:
        os.chdir(before)
    assert result.exit_code == 0, f"{line}\n{result.output}"
    return result


def lines_of(config):
    return LINE.findall(config.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with the data, the configs and all that the specs without edits make."""
    folder = tmp_path_factory.mktemp("configs")
    for name in ("data", "configs"):
        (folder / name).symlink_to(ROOT / name)
    for name in FIRST:
        for line in lines_of(ROOT / "configs" / name):
            run(line, folder)
    return folder


@pytest.mark.parametrize("config", CONFIGS, ids=lambda path: path.name)
def test_a_spec_runs_as_it_says(config, folder):
    lines = lines_of(config)
    first = shlex.split(lines[0])
    assert first[first.index("-s") + 1] == f"configs/{config.name}"
    output = folder / first[first.index("-o") + 1]
    if config.name not in FIRST:
        edits = first[1] == "edit-pc"
        run(f"{lines[0]} --report out/report.json {'--verify' if edits else ''}", folder)
        for line in lines[1:]:
            run(line, folder)
        report = json.loads((folder / "out" / "report.json").read_text())
        assert {clip["status"] for clip in report["clips"]} <= {"ok", "far"}
    assert output.exists()


@pytest.mark.parametrize("config", CONFIGS, ids=lambda path: path.name)
def test_a_spec_says_what_it_is_for_and_names_its_schema_first(config):
    text = config.read_text(encoding="utf-8")
    assert re.match(r"# [A-Z].*[.:]\n#   motionedit ", text)
    keys = [line for line in text.splitlines() if line and not line.startswith("#")]
    assert re.fullmatch(r"schema: motionedit/[a-z-]+/v1", keys[0])


def test_the_paper_output_is_on_the_timeline(folder):
    run(lines_of(ROOT / "configs" / "golf-edit-paper.yaml")[0], folder)
    edited = read_clip(folder / "out" / "swing04-paper.bvh").motion
    assert len(edited) == len(read_clip(folder / "out" / "golf-normalized" / "swing04.bvh").motion)


def test_the_hit_of_a_hand_is_found_where_the_table_has_it(folder):
    found = json.loads((folder / "out" / "stroke-normalized" / "normalization.json").read_text())["clips"]
    known = dict(line.split(",") for line in (ROOT / "data" / "golf" / "events.csv").read_text().splitlines()[1:])
    assert all(abs(clip["events"]["hit"] - int(known[Path(clip["clip"]).stem])) < 2.0 for clip in found)


@pytest.mark.skipif(not SMASHES.is_dir(), reason="MOTIONEDIT_CLIPS names no folder with real strokes")
def test_the_stroke_specs_serve_real_strokes(folder):
    lines = [*lines_of(ROOT / "configs" / "stroke-normalize.yaml"), *lines_of(ROOT / "configs" / "stroke-edit.yaml")]
    joints = {
        "normalize": "--set events.hit.detect.effector=RightWrist",
        "edit-pc": "--set goals.hand.effector=RightWrist",
    }
    for line in lines:
        command = line.split()[1]
        real = line.replace("data/golf", str(SMASHES)).replace("out/stroke", "out/real")
        result = run(f"{real} {joints.get(command, '')}", folder)
    assert "11 clips: 11 ok" in result.output
