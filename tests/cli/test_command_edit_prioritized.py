"""`motionedit edit-prioritized` from the outside: files, streams, reports and exit codes of a run."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from studies.lab import effector_path

EDIT = "edit-prioritized"


@pytest.fixture
def edit(run, copy_spec):
    """Return a runner of edit-prioritized with the spec that changes nothing."""

    def invoke(*arguments, **how):
        return run(EDIT, *arguments, "-s", copy_spec.name, **how)

    return invoke


def test_a_folder_comes_out_with_its_layout_and_its_bytes(edit, clip):
    for n, name in enumerate(("in/b.bvh", "in/A.BVH", "in/deep/c.bvh")):
        clip(name, seed=n)
    result = edit("in", "-o", "out")
    assert result.exit_code == 0
    assert result.stdout == "out/A.BVH\nout/b.bvh\nout/deep/c.bvh\n"
    for path in result.stdout.split():
        assert Path(path).read_bytes() == Path(path.replace("out", "in", 1)).read_bytes()
    assert "3 clips: 3 ok" in result.stderr


def test_one_clip_to_a_file(edit, clip):
    clip("walk.bvh")
    assert edit("walk.bvh", "-o", "new/edited.bvh").stdout == "new/edited.bvh\n"
    assert Path("new/edited.bvh").read_bytes() == Path("walk.bvh").read_bytes()


def test_standard_input_to_standard_output_byte_for_byte(edit, clip):
    data = clip("walk.bvh").read_bytes().replace(b"\n", b"\r\n")
    result = edit("-", "-o", "-", stdin=data)
    assert result.exit_code == 0
    assert result.stdout_bytes == data


def test_quiet_says_nothing_but_the_paths(edit, clip):
    clip("walk.bvh")
    for place in ("before", "after"):
        result = edit("walk.bvh", "-o", "out", "-q") if place == "after" else None
        assert result is None or (result.stdout, result.stderr) == ("out/walk.bvh\n", "")


def test_the_same_bytes_and_the_same_report_for_any_jobs(edit, clip):
    for n in range(4):
        clip(f"in/{n}.bvh", seed=n)
    Path("in/2.bvh").write_text("no clip")
    results = [edit("in", "-o", "out", "-j", jobs, "--report", f"{jobs}.json") for jobs in (1, 2, 0)]
    assert {result.exit_code for result in results} == {1}
    assert len({result.stdout for result in results}) == 1
    assert Path("1.json").read_bytes() == Path("2.json").read_bytes() == Path("0.json").read_bytes()


def test_the_report_has_its_fixed_keys_and_lists_failed_clips(edit, clip):
    clip("in/a.bvh")
    clip("in/b.bvh").write_text("no clip")
    result = edit("in", "-o", "out", "--report", "r.json", "--set", "unit=cm")
    report = json.loads(Path("r.json").read_text())
    assert result.exit_code == 1
    assert result.stdout == "out/a.bvh\n"
    assert list(report) == ["schema", "version", "command", "spec", "clips"]
    assert report["schema"] == "motionedit/report/v1"
    assert report["command"] == EDIT
    assert report["spec"] == {"schema": "motionedit/edit-prioritized/v1", "constraints": [], "unit": "cm"}
    assert [(c["clip"], c["output"], c["status"]) for c in report["clips"]] == [
        ("in/a.bvh", "out/a.bvh", "ok"),
        ("in/b.bvh", None, "failed"),
    ]
    assert report["clips"][1]["message"].startswith("in/b.bvh:1: ")
    assert f"motionedit: error: {report['clips'][1]['message']}\n" in result.stderr


def test_the_report_on_standard_output_takes_the_place_of_the_paths(edit, clip):
    clip("a.bvh")
    assert json.loads(edit("a.bvh", "-o", "out", "--report", "-").stdout)["clips"][0]["output"] == "out/a.bvh"


def test_the_report_is_not_written_over_a_clip(edit, clip):
    clip("a.bvh")
    result = edit("a.bvh", "-o", "out", "--report", "a.bvh")
    assert result.exit_code == 2
    assert not Path("out").exists()


def test_nothing_is_started_where_the_spec_is_wrong(run, clip, tmp_path):
    clip("a.bvh")
    (tmp_path / "s.yaml").write_text("schema: motionedit/edit-prioritized/v1\nhinge: auto\nconstraints: 3\n")
    result = run(EDIT, "a.bvh", "-s", "s.yaml", "-o", "out", "--report", "r.json")
    assert result.exit_code == 2
    assert result.stderr.startswith("motionedit: error: s.yaml:2: hinge: ")
    assert "motionedit: error: s.yaml:3: constraints: " in result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.bvh", "s.yaml"]


SPEC = "schema: motionedit/edit-prioritized/v1\n"
CONSTRAINT = "constraints:\n  - {type: position, effector: LeftArm, priority: 1, points: [{at: 3, shift: [1, 0, 0]}]}\n"


def test_a_joint_that_only_some_clips_lack_fails_those(run, clip, tmp_path):
    clip("in/a.bvh")
    clip("in/b.bvh", names=("Hips", "Spine1"))
    (tmp_path / "s.yaml").write_text(f"{SPEC}hinges: [LeftArm]\nconstraints: []\n")
    result = run(EDIT, "in", "-s", "s.yaml", "-o", "out")
    assert (result.exit_code, result.stdout) == (1, "out/a.bvh\n")
    assert "motionedit: error: s.yaml:2: hinges.0: no joint 'LeftArm' in in/b.bvh" in result.stderr


def test_a_joint_that_every_clip_lacks_is_the_specs_fault_said_once(run, clip, tmp_path):
    for name in "abc":
        clip(f"in/{name}.bvh")
    (tmp_path / "s.yaml").write_text(f"{SPEC}masses: {{LeftArn: 3}}\nconstraints: []\n")
    result = run(EDIT, "in", "-s", "s.yaml", "-o", "out")
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = [line for line in result.stderr.splitlines() if "error" in line]
    assert line == (
        "motionedit: error: s.yaml:2: masses.LeftArn: no joint 'LeftArn' in in/a.bvh; "
        "did you mean 'LeftArm'? (and in 2 more clips)"
    )


def test_a_constraint_edits_a_chain_that_is_no_human(run, clip, tmp_path):
    clip("a.bvh")
    (tmp_path / "s.yaml").write_text(SPEC + CONSTRAINT)
    result = run(EDIT, "a.bvh", "-s", "s.yaml", "-o", "out")
    assert result.exit_code == 0
    assert "no legs found" in result.stderr
    before, after = (effector_path(Path(path), "LeftArm")[3] for path in ("a.bvh", "out/a.bvh"))
    np.testing.assert_allclose(after - before, [1, 0, 0], atol=1e-4)


def test_a_dry_run_prints_and_writes_nothing(edit, clip, tmp_path):
    clip("a.bvh")
    result = edit("a.bvh", "-o", "out", "--dry-run", "--report", "r.json")
    assert result.exit_code == 0
    assert result.stdout == (
        "would write a.bvh -> out/a.bvh\n  no constraints: the same bytes\nwould write the report r.json\n"
    )
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.bvh", "copy.yaml"]


def test_no_overwrite_refuses_before_any_work(edit, clip):
    for name in "ab":
        clip(f"in/{name}.bvh")
    edit("in", "-o", "out")
    Path("out/a.bvh").unlink()
    result = edit("in", "-o", "out", "--no-overwrite")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == "motionedit: error: out/b.bvh: exists, and --no-overwrite is given\n"
    assert not Path("out/a.bvh").exists()


def test_no_overwrite_keeps_a_report_but_takes_streams(edit, clip, tmp_path):
    clip("a.bvh")
    (tmp_path / "r.json").write_text("kept")
    result = edit("a.bvh", "-o", "out", "--report", "r.json", "--no-overwrite")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == "motionedit: error: r.json: exists, and --no-overwrite is given\n"
    assert (tmp_path / "r.json").read_text() == "kept"
    assert not Path("out").exists()
    assert edit("a.bvh", "-o", "out", "--report", os.devnull, "--no-overwrite").exit_code == 0


def test_update_resumes_a_stopped_batch(edit, clip):
    for name in "ab":
        clip(f"in/{name}.bvh")
    edit("in", "-o", "out")
    Path("out/b.bvh").unlink()
    assert edit("in", "-o", "out", "--update").stdout == "out/b.bvh\n"
    result = edit("in", "-o", "out", "--update")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "2 up to date\n")


def test_of_many_clips_that_are_ok_their_number_alone_is_said(edit, clip):
    for n in range(41):
        clip(f"in/{n}.bvh")
    lines = edit("in", "-o", "out").stderr.split("\n")
    assert [line for line in lines if "warning: " not in line] == ["41 clips: 41 ok", ""]


def test_outputs_are_replaced_and_their_time_renewed(edit, clip):
    clip("a.bvh")
    edit("a.bvh", "-o", "out")
    before = Path("out/a.bvh").stat().st_mtime_ns
    edit("a.bvh", "-o", "out")
    assert Path("out/a.bvh").stat().st_mtime_ns > before


@pytest.mark.filterwarnings("ignore:Importing PyGLM:PendingDeprecationWarning")  # bvhio's own affair
def test_verify_reads_the_file_back(edit, clip):
    clip("a.bvh", frames=20)
    result = edit("a.bvh", "-o", "out", "--verify", "--report", "-")
    assert result.exit_code == 0, result.stderr
    (entry,) = json.loads(result.stdout)["clips"]
    assert 0.0 <= entry["verify"]["distance"] < 0.01
    assert entry["verify"]["frames_skipped"] == 0


def test_lenient_accepts_a_wrong_row_count_with_a_warning(edit, clip):
    path = clip("a.bvh")
    path.write_text(path.read_text().replace("Frames: 8", "Frames: 9"))
    assert edit("a.bvh", "-o", "out").exit_code == 1
    result = edit("a.bvh", "-o", "out", "--lenient")
    assert result.exit_code == 0
    assert "motionedit: warning: a.bvh" in result.stderr
