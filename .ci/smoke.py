"""A short trial of an installed motionedit, on any system: its version, edits alone and by workers, files and pipes.

Usage: python .ci/smoke.py SOLVER

SOLVER is `compiled` or `numpy`: the one that the install should have. The Python that runs this is the one that
motionedit is installed for; clips and specs are those beside this script.
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WALK, KICK, SPEC = ROOT / "data" / "walk.bvh", ROOT / "data" / "kick.bvh", ROOT / "configs" / "step.yaml"


def main(solver: str) -> int:
    """Return 0 where all is as it should be; say what is not."""
    with tempfile.TemporaryDirectory(prefix="motionedit-") as scratch:
        complaints = list(faults(solver, Path(scratch)))
    for complaint in complaints:
        print(f"smoke: error: {complaint}")
    if not complaints:
        print(f"smoke: the {solver} solver edits, alone and by workers, files and pipes")
    return 1 if complaints else 0


def faults(solver: str, folder: Path) -> list[str]:
    """Return what is wrong; where an edit fails, nothing further is tried."""
    found: list[str] = []
    version = run("--version").stdout.decode().strip()
    if not version.endswith(f"({solver} solver)"):
        found.append(f"'motionedit --version' says '{version}', not the {solver} solver")
    edit = ["edit-prioritized", "-s", SPEC, "-q"]
    done = run(*edit, WALK, "-o", folder / "alone.bvh")
    if done.returncode:
        return [*found, f"an edit ended with {done.returncode}: {done.stderr.decode(errors='replace')}"]
    alone = (folder / "alone.bvh").read_bytes()
    if run("diff", WALK, folder / "alone.bvh").returncode != 3:
        found.append("the edit moved nothing")
    if run(*edit, "-", "-o", "-", given=WALK.read_bytes()).stdout != alone:
        found.append("a clip through pipes is not the same bytes as a file")
    run(*edit, WALK, KICK, "-o", folder / "both", "-j", "2")
    if sorted(path.name for path in (folder / "both").glob("*.bvh")) != [KICK.name, WALK.name]:
        found.append("two workers wrote other files than one each")
    elif (folder / "both" / WALK.name).read_bytes() != alone:
        found.append("a worker wrote other bytes than an edit alone")
    return found


def run(*arguments: str | Path, given: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    """Run the command that is installed beside this Python."""
    program = Path(sysconfig.get_path("scripts")) / "motionedit"
    return subprocess.run([program, *arguments], input=given, capture_output=True, check=False)


if __name__ == "__main__":
    if sys.argv[1:] not in (["compiled"], ["numpy"]):
        sys.exit("usage: python .ci/smoke.py compiled|numpy")
    sys.exit(main(sys.argv[1]))
