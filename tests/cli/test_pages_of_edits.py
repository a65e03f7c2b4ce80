"""Pages of edits: `preview --report` and `--preview`, what is on them, and when they are written."""

import base64
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
WALK = ROOT / "data" / "walk.bvh"
REACH = ROOT / "configs" / "reach.yaml"
LIFT = """\
schema: motionedit/edit-prioritized/v1
constraints:
  - {name: arm, type: position, effector: LeftForeArm, priority: 1, tolerance: off, points: [{at: 4, shift: [0, 1, 0]}]}
"""


def edits_of(page):
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'<script id="edits" type="application/json">(.*?)</script>', text, re.DOTALL).group(1))


def floats(text):
    return np.frombuffer(base64.b64decode(text), "<f4")


@pytest.fixture
def reached(run, tmp_path):
    """Return the report of the walk that reaches for a shelf, written to out/walk.bvh."""
    result = run("edit-prioritized", WALK, "-s", REACH, "-o", "out/walk.bvh", "--report", "r.json", "-q")
    assert result.exit_code == 0, result.stderr
    return tmp_path / "r.json"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "lift.yaml"
    path.write_text(LIFT)
    return path


def test_a_page_has_the_constraints_of_the_report(run, reached, tmp_path):
    result = run("preview", WALK, "out/walk.bvh", "-o", "p.html", "--report", reached)
    assert (result.exit_code, result.stdout) == (0, "p.html\n"), result.stderr
    (edit,) = edits_of(tmp_path / "p.html")
    assert (edit["clip"], edit["status"], edit["unit"]) == (1, "ok", "cm")
    marks = edit["marks"]
    assert [(m["name"], m["priority"]) for m in marks[3:]] == [("feet-4", 10), ("hand", 4), ("balance", 2)]
    hand, reported = marks[4], json.loads(reached.read_text())["clips"][0]["constraints"][4]
    assert (hand["first"], hand["last"], hand["spans"]) == (49, 89, [["hold", 66, 72]])
    places = floats(hand["places"]).reshape(-1, 3)
    np.testing.assert_allclose(places[66 - 49 : 73 - 49], [[58, 150, 322]] * 7, rtol=1e-6)
    np.testing.assert_allclose(floats(hand["lengths"]["values"]), reported["frames"]["error"], rtol=1e-6)
    assert (hand["lengths"]["tolerance"], [body for body, _ in hand["points"]]) == (0.1, [1, 0])


def test_a_page_of_two_clips_of_145_frames_and_their_edit_stays_under_400_kb(run, reached, tmp_path):
    run("preview", WALK, "out/walk.bvh", "-o", "p.html", "--report", reached)
    assert (tmp_path / "p.html").stat().st_size < 400_000


def test_a_page_has_the_goals_of_edit_pc(run, golf, tmp_path):
    spec = golf.spec(
        tmp_path / "s.yaml",
        unit="cm",
        goals=[{"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, "shift": [0, 0, 10], "tolerance": 0.1}],
    )
    swing = golf.swings[3]
    run("edit-pc", swing, "-m", golf.model, "-s", spec, "-o", "new.bvh", "--report", "r.json")
    assert run("preview", swing, "new.bvh", "-o", "p.html", "--report", "r.json").exit_code == 0
    (edit,) = edits_of(tmp_path / "p.html")
    (mark,) = edit["marks"]
    record = json.loads((tmp_path / "r.json").read_text())["clips"][0]["goals"][0]
    assert (mark["name"], mark["kind"], mark["first"], mark["last"]) == ("ball", "goal", 85, 85)
    np.testing.assert_allclose(floats(mark["places"]), record["target"], rtol=1e-6)


def test_without_a_report_a_page_has_no_goals(run, tmp_path):
    run("preview", WALK, "-o", "p.html")
    assert edits_of(tmp_path / "p.html") == []


def test_clips_that_were_moved_are_found_by_their_stem_the_edited_one_after_its_input(run, reached, tmp_path):
    for name, source in (("a", WALK), ("b", tmp_path / "out" / "walk.bvh")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "walk.bvh").write_bytes(source.read_bytes())
    (tmp_path / "out" / "walk.bvh").unlink()
    assert run("preview", "a/walk.bvh", "b/walk.bvh", "-o", "p.html", "--report", reached).exit_code == 0
    (edit,) = edits_of(tmp_path / "p.html")
    assert edit["clip"] == 1
    assert [body for body, _ in edit["marks"][0]["points"]] == [1, 0]


def test_the_input_is_not_taken_for_the_edited_clip_of_its_name(run, reached):
    result = run("preview", WALK, "-o", "p.html", "--report", reached)
    assert result.exit_code == 2
    assert "fits none of the clips given: it wrote out/walk.bvh; give that too" in result.stderr


def test_of_two_clips_the_other_one_is_the_input_whatever_its_name(run, reached, tmp_path):
    (tmp_path / "before.bvh").write_bytes(WALK.read_bytes())
    run("preview", "out/walk.bvh", "before.bvh", "-o", "p.html", "--report", reached)
    assert [body for body, _ in edits_of(tmp_path / "p.html")[0]["marks"][0]["points"]] == [0, 1]


def test_the_path_of_the_output_counts_before_any_stem(run, reached, tmp_path):
    (tmp_path / "walk.bvh").write_bytes(WALK.read_bytes())
    run("preview", "out/walk.bvh", "walk.bvh", "-o", "p.html", "--report", reached)
    assert edits_of(tmp_path / "p.html")[0]["clip"] == 0


def test_of_two_outputs_of_one_name_none_is_found_by_its_stem(run, clip, spec):
    clip("takes/a/walk.bvh")
    clip("takes/b/walk.bvh")
    run("edit-prioritized", "takes", "-s", spec, "-o", "out", "--report", "r.json")
    moved = clip("walk.bvh")
    assert "fits none of the clips given" in run("preview", moved, "-o", "p.html", "--report", "r.json").stderr
    found = run("preview", "takes", "out", "-o", "p.html", "--report", "r.json")
    assert found.exit_code == 0
    assert [edit["clip"] for edit in edits_of(Path("p.html"))] == [2, 3]
    assert [edit["marks"][0]["points"][1][0] for edit in edits_of(Path("p.html"))] == [0, 1]


HEAD = '{"schema": "motionedit/report/v1", "command": "edit-pc", "clips": ['


@pytest.mark.parametrize(
    ("content", "line"),
    [
        ("no", "r.json: is no JSON; give a report that an edit wrote with --report"),
        ("\udcff", "r.json: is no JSON"),
        ("[]", "r.json: is no report (motionedit/report/v1)"),
        ('{"schema": "motionedit/report/v2", "clips": []}', "r.json: is no report (motionedit/report/v1)"),
        ('{"schema": "motionedit/report/v1", "clips": 3, "command": "edit-pc"}', "r.json: is no report"),
        (
            '{"schema": "motionedit/report/v1", "clips": [], "command": "diff"}',
            "a report of diff; a page shows those of",
        ),
        ('{"schema": "motionedit/report/v1", "clips": [], "command": "edit-pc"}', "the clips given: it wrote none"),
        (
            f'{HEAD}{{"output": "x/1.bvh"}}, 3, {{"output": "x/2.bvh"}}, {{"output": null}}]}}',
            "r.json: fits none of the clips given: it wrote x/1.bvh and 1 more; give that too",
        ),
        (
            f'{HEAD}{{"output": "walk.bvh"}}]}}',
            "r.json: does not fit walk.bvh: another clip's, or not as an edit writes it",
        ),
    ],
    ids=["text", "bytes", "list", "version", "clips", "command", "empty", "others", "form"],
)
def test_a_report_that_does_not_fit_is_one_line_and_exit_code_2(run, clip, tmp_path, content, line):
    clip("walk.bvh")
    (tmp_path / "r.json").write_bytes(content.encode(errors="surrogateescape"))
    result = run("preview", "walk.bvh", "-o", "p.html", "--report", "r.json")
    assert (result.exit_code, result.stdout) == (2, "")
    assert line in result.stderr
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "p.html").exists()


def test_the_report_is_never_overwritten_by_the_page(run, clip, tmp_path):
    (tmp_path / "r.html").write_text("{}")
    result = run("preview", clip(), "-o", "r.html", "--report", "r.html")
    assert result.exit_code == 2
    assert "is an input of this run" in result.stderr


def test_an_edit_writes_the_page_that_preview_would_after_the_clip(run, clip, spec, tmp_path):
    source = clip("takes/walk.bvh")
    result = run("edit-prioritized", "takes/walk.bvh", "-s", spec, "-o", "out", "--preview", "--report", "r.json")
    assert result.stdout.splitlines() == ["out/walk.bvh", "out/walk.html"]
    run("preview", "takes/walk.bvh", "out/walk.bvh", "-o", "p.html", "--report", "r.json")
    assert (tmp_path / "out" / "walk.html").read_bytes() == (tmp_path / "p.html").read_bytes()
    assert [m["name"] for m in edits_of(tmp_path / "p.html")[0]["marks"]] == ["arm"]
    assert source.exists()


def test_edit_pc_writes_pages_too(run, golf, tmp_path):
    spec = golf.spec(tmp_path / "s.yaml", goals=[{"at": "hit", "effector": {"end_site": "Club"}, "shift": [0, 0, 1]}])
    result = run("edit-pc", golf.swings[0], "-m", golf.model, "-s", spec, "-o", "new.bvh", "--preview")
    assert result.stdout.splitlines() == ["new.bvh", "new.html"]
    assert edits_of(tmp_path / "new.html")[0]["marks"][0]["name"] == "Club"


def test_a_spec_without_constraints_has_a_page_without_goals(run, clip, copy_spec, tmp_path):
    assert run("edit-prioritized", clip(), "-s", copy_spec, "-o", "new.bvh", "--preview").exit_code == 0
    assert edits_of(tmp_path / "new.html")[0]["marks"] == []


def test_pages_are_the_same_bytes_for_any_number_of_workers(run, clip, spec, tmp_path):
    for seed in range(3):
        clip(f"takes/{seed}.bvh", seed=seed)
    written = []
    for jobs in (1, 2):
        run("edit-prioritized", "takes", "-s", spec, "-o", "out", "--preview", "-j", jobs)
        written.append({path.name: path.read_bytes() for path in sorted((tmp_path / "out").glob("[!.]*"))})
    assert written[0] == written[1]
    assert list(written[0]) == ["0.bvh", "0.html", "1.bvh", "1.html", "2.bvh", "2.html"]


def test_a_dry_run_names_the_page_and_writes_none(run, clip, spec, tmp_path):
    result = run("edit-prioritized", clip(), "-s", spec, "-o", "out", "--preview", "--dry-run")
    assert f"would write {tmp_path / 'walk.bvh'} -> out/walk.bvh, out/walk.html" in result.stdout
    assert not (tmp_path / "out").exists()


def test_a_page_has_no_place_beside_standard_output(run, clip, spec):
    result = run("edit-prioritized", clip(), "-s", spec, "-o", "-", "--preview")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--preview writes a page next to each clip: it does not go with -o -" in result.stderr


def test_no_overwrite_minds_the_pages(run, clip, spec, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "walk.html").write_text("mine")
    arguments = ("edit-prioritized", clip(), "-s", spec, "-o", "out", "--no-overwrite")
    result = run(*arguments, "--preview")
    assert result.exit_code == 2
    assert "walk.html: exists" in result.stderr
    assert not (tmp_path / "out" / "walk.bvh").exists()
    assert run(*arguments).exit_code == 0
    assert (tmp_path / "out" / "walk.html").read_text() == "mine"


def test_update_makes_a_page_that_is_missing_and_leaves_one_that_is_there(run, clip, spec, tmp_path):
    arguments = ("edit-prioritized", clip(), "-s", spec, "-o", "out", "--update")
    run(*arguments)
    assert run(*arguments, "--preview").stdout.splitlines() == ["out/walk.bvh", "out/walk.html"]
    again = run(*arguments, "--preview")
    assert (again.stdout, "1 up to date" in again.stderr) == ("", True)
    (tmp_path / "out" / "walk.html").unlink()
    assert run(*arguments).stdout == ""
    assert len(run(*arguments, "--preview").stdout.splitlines()) == 2


def test_update_makes_a_page_anew_that_is_older_than_the_spec(run, clip, spec, tmp_path):
    arguments = ("edit-prioritized", clip(), "-s", spec, "-o", "out", "--update", "--preview")
    run(*arguments)
    older = spec.stat().st_mtime_ns - 10**9
    os.utime(tmp_path / "out" / "walk.html", ns=(older, older))
    assert len(run(*arguments).stdout.splitlines()) == 2


def test_clips_that_would_share_a_page_are_refused(run, clip, spec):
    clip("takes/walk.bvh")
    clip("takes/walk.BVH")
    result = run("edit-prioritized", "takes", "-s", spec, "-o", "out", "--preview")
    assert result.exit_code == 2
    assert "would both be written to out/walk.html" in result.stderr
    assert run("edit-prioritized", "takes", "-s", spec, "-o", "out").exit_code == 0


def test_the_report_and_a_page_cannot_be_one_file(run, clip, spec):
    result = run("edit-prioritized", clip(), "-s", spec, "-o", "out", "--preview", "--report", "out/walk.html")
    assert result.exit_code == 2
    assert "the report" in result.stderr


def test_a_clip_that_fails_has_no_page(run, clip, spec, tmp_path):
    clip("takes/good.bvh")
    (tmp_path / "takes" / "bad.bvh").write_text("HIERARCHY\n")
    result = run("edit-prioritized", "takes", "-s", spec, "-o", "out", "--preview")
    assert result.exit_code == 1
    assert result.stdout.splitlines() == ["out/good.bvh", "out/good.html"]
    assert sorted(path.name for path in (tmp_path / "out").glob("[!.]*")) == ["good.bvh", "good.html"]


def test_a_page_that_cannot_be_written_fails_its_clip_by_name(run, clip, spec, tmp_path):
    (tmp_path / "out" / "walk.html").mkdir(parents=True)
    result = run("edit-prioritized", clip(), "-s", spec, "-o", "out", "--preview")
    assert result.exit_code == 1
    assert "out/walk.html: cannot be written" in result.stderr


@pytest.mark.parametrize("asked", [[], ["--preview"]], ids=["clip", "page"])
def test_nothing_of_the_page_is_loaded_unless_it_is_asked_for_and_never_a_plotting_library(clip, spec, tmp_path, asked):
    arguments = ["edit-prioritized", str(clip()), "-s", str(spec), "-o", str(tmp_path / "new.bvh"), *asked]
    code = f"import sys\nfrom motionedit.cli import main\ntry: main({arguments!r})\nexcept SystemExit: pass\n"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}print('LOADED', *sys.modules)"], capture_output=True, text=True, check=True
    )
    loaded = set(done.stdout.rpartition("LOADED")[2].split())
    pages = {"motionedit.jobs.preview.job", "motionedit.jobs.preview.marks", "motionedit.report.preview.page"}
    assert loaded & pages == (pages if asked else set())
    assert "matplotlib" not in loaded
