"""What a report tells frame by frame: of one clip, and where it is asked for; and the records of many clips."""

import json
from pathlib import Path

import pytest

from motionedit.errors import ClipError
from motionedit.jobs.batch import records as shelf
from motionedit.jobs.batch.records import Records

REACH = {"name": "up", "type": "position", "effector": "LeftForeArm", "points": [{"at": 4, "shift": [0, 1, 0]}]}


@pytest.fixture
def report(run, clip, tmp_path):
    """Return a runner of an edit of so many clips; it returns the report's clips."""
    (tmp_path / "s.yaml").write_text(json.dumps({"schema": "motionedit/edit-prioritized/v1", "constraints": [REACH]}))

    def go(clips, *more):
        for n in range(clips):
            clip(f"in/{n}.bvh", seed=n)
        done = run("edit-prioritized", "in", "-s", "s.yaml", "-o", "out", "--report", "r.json", *more)
        assert done.exit_code == 0, done.stderr
        return json.loads(Path("r.json").read_text())["clips"]

    return go


def told(clip):
    return ["frames" in clip, "frames" in clip["constraints"][0], "frames" in clip["layers"][0]]


@pytest.mark.parametrize(
    ("clips", "options", "wanted"),
    [
        (1, (), True),
        (1, ("--no-report-frames",), False),
        (2, (), False),
        (2, ("--report-frames", "-j", "2"), True),
    ],
)
def test_frames_are_told_of_one_clip_or_where_they_are_asked_for(report, clips, options, wanted):
    found = report(clips, *options)
    assert len(found) == clips
    assert [told(clip) for clip in found] == [[wanted] * 3] * clips


def test_all_else_is_the_same_with_frames_and_without(report):
    bare, full = report(2), report(2, "--report-frames")
    for clip in full:
        del clip["frames"]
        for part in (*clip["constraints"], *clip["layers"]):
            del part["frames"]
    assert bare == full


def test_verdicts_hold_no_frames_of_several_clips(report):
    report(2)
    assert b'"frames"' not in Path("out/.motionedit-verdicts.jsonl").read_bytes()


def test_a_page_of_a_report_without_frames_has_the_intervals(report, run):
    report(2)
    done = run("preview", "in/1.bvh", "out/1.bvh", "-o", "page.html", "--report", "r.json")
    assert done.exit_code == 0, done.stderr
    assert '"name":"up"' in Path("page.html").read_text().replace(": ", ":")


def test_a_page_beside_one_of_several_clips_has_paths_and_errors(report, run):
    report(2, "--preview")
    beside = Path("out/1.html").read_text()
    report(2, "--report-frames")
    run("preview", "in/1.bvh", "out/1.bvh", "-o", "later.html", "--report", "r.json")
    assert Path("later.html").read_text() == beside


@pytest.mark.parametrize("in_memory", [0, 100, 1 << 20])
def test_records_come_back_in_order_from_memory_and_from_disk(in_memory):
    entries = [{"clip": f"{n}.bvh", "values": list(range(n))} for n in range(20)]
    records = Records(entries[:10], in_memory=in_memory)
    assert records[3] == entries[3]
    for entry in entries[10:]:
        records.append(entry)
    assert list(records) == entries
    assert (len(records), records[-1], records[2:4]) == (20, entries[-1], entries[2:4])


def test_a_full_disk_of_temporary_files_is_said(monkeypatch):
    def full(_stream):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(shelf, "_on_disk", full)
    with pytest.raises(ClipError, match="No space left on device; TMPDIR"):
        Records([{"clip": "a.bvh"}], in_memory=0)
