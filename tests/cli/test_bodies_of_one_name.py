"""What is read off a skeleton once for a folder is that skeleton's own, not that of another with the same joints."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
REACH = ROOT / "configs" / "reach.yaml"


def test_clips_with_equal_joints_and_other_bones_come_out_of_a_folder_as_alone(run, tmp_path):
    walk = (ROOT / "data" / "walk.bvh").read_bytes()
    longer, count = re.subn(rb"(JOINT LeftLeg\s*\{\s*OFFSET) \S+ \S+ \S+", rb"\1 0 -9 1", walk)
    assert count == 1
    (tmp_path / "in").mkdir()
    for n, data in enumerate((walk, longer, walk, longer)):
        (tmp_path / "in" / f"{n}.bvh").write_bytes(data)
    assert run("edit-prioritized", "in", "-s", REACH, "-o", "together", "-q").exit_code == 0
    for n in (1, 2):
        # In a program of its own: nothing of the other skeleton was ever read there.
        command = [
            sys.executable,
            "-m",
            "motionedit",
            "edit-prioritized",
            f"in/{n}.bvh",
            "-s",
            REACH,
            "-o",
            "alone",
            "-q",
        ]
        subprocess.run(command, check=True)
    outputs = [Path(f"together/{n}.bvh").read_bytes() for n in range(4)]
    assert [Path("alone/1.bvh").read_bytes(), Path("alone/2.bvh").read_bytes()] == outputs[1:3]
    assert outputs[:2] == outputs[2:]
