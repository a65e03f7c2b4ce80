"""The recipes of regression-testing.md do what they say: they pass where motions are the same, and fail where not."""

import re
import shutil
from xml.etree import ElementTree as ET

import pytest
import yaml
from recipes import block


@pytest.fixture
def text(root):
    return (root / "docs" / "regression-testing.md").read_text(encoding="utf-8")


@pytest.fixture
def other_spec(root, tmp_path):
    """Return a spec that lifts the foot two centimetres higher, beside the one of the page."""
    spec = (root / "configs" / "step.yaml").read_text(encoding="utf-8")
    changed = spec.replace("shift: [0, 28, 0]", "shift: [0, 30, 0]")
    assert changed != spec
    (tmp_path / "other.yaml").write_text(changed, encoding="utf-8")
    return "other.yaml"


@pytest.mark.compiled
@pytest.mark.skipif(shutil.which("make") is None, reason="no make on this machine")
def test_the_makefile_passes_until_a_motion_changes_and_again_when_it_is_accepted(text, shell, other_spec, tmp_path):
    (tmp_path / "motions.mk").write_text(block(text, "make", "motions.mk"), encoding="utf-8")
    make = "make -f motions.mk"
    assert shell(f"{make} check-motions")[0] != 0  # nothing is expected yet
    assert shell(f"{make} accept-motions")[0] == 0
    code, printed = shell(f"{make} check-motions")
    assert (code, "walk.bvh: same" in printed) == (0, True), printed
    code, printed = shell(f"{make} check-motions SPEC={other_spec}")
    assert code != 0
    assert re.search(r"walk\.bvh: different: 2(\.0\d*)? apart at frame 56, joint Right", printed)
    assert ET.parse(tmp_path / "written" / "motions.xml").getroot().get("failures") == "1"  # noqa: S314  our own file
    shell(f"{make} accept-motions SPEC={other_spec}")
    assert shell(f"{make} check-motions SPEC={other_spec}")[0] == 0


def run_job(steps, shell):
    """Run a job's own lines as a server does; return whether it failed, and the lines that ran."""
    failed, ran = False, []
    for step in steps:
        if "run" not in step or "pip install" in step["run"]:
            continue
        wanted = {"success()": not failed, "failure()": failed}[step.get("if", "success()")]
        if wanted:
            ran.append(step["run"])
            failed |= shell(step["run"])[0] != 0
    return failed, ran


@pytest.mark.compiled
def test_the_job_passes_where_motions_are_the_same_and_shows_them_where_they_are_not(text, shell, other_spec, tmp_path):
    job = yaml.safe_load(block(text, "yaml", "motions.yml"))["jobs"]["motions"]["steps"]
    uploaded = job[-1]["with"]["path"].split()
    shell("motionedit edit-prioritized data/walk.bvh -s configs/step.yaml -o expected")
    failed, ran = run_job(job, shell)
    assert (failed, len(ran)) == (False, 2)
    shell(f"motionedit edit-prioritized data/walk.bvh -s {other_spec} -o expected")
    failed, ran = run_job(job, shell)
    assert (failed, len(ran)) == (True, 3)
    assert all((tmp_path / name).stat().st_size for name in uploaded)
    case = ET.parse(tmp_path / "motions.xml").getroot().find(".//testcase")  # noqa: S314  our own file
    assert (case.get("name"), case[0].tag) == ("walk.bvh", "failure")
