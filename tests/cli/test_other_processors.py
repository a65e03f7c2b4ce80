"""What is written does not depend on the processor, whose vectors add up in another order, and round otherwise."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
WIDE = "AVX2 FMA3 AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL"
# Where these have no such names they are left alone.
OLDER = {"OPENBLAS_CORETYPE": "Nehalem", "NPY_DISABLE_CPU_FEATURES": WIDE}


@pytest.mark.compiled
@pytest.mark.parametrize(("clip", "spec"), [("walk", "stairs"), ("kick", "karate")])
def test_an_edit_and_its_report_are_the_same_bytes_on_an_older_processor(clip, spec, tmp_path):
    written = []
    for name, environment in (("newer", {}), ("older", OLDER)):
        folder = tmp_path / name
        folder.mkdir()
        for part in ("data", "configs"):
            (folder / part).symlink_to(ROOT / part)
        edit = ["edit-prioritized", f"data/{clip}.bvh", "-s", f"configs/{spec}.yaml", "-o", "e.bvh"]
        command = [sys.executable, "-m", "motionedit", *edit, "--report", "e.json", "-q"]
        subprocess.run(command, cwd=folder, env={**os.environ, **environment}, check=True)
        written.append([(folder / file).read_bytes() for file in ("e.bvh", "e.json")])
    assert written[0] == written[1]
