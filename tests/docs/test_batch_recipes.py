"""The recipes of batches.md write, with make and as a SLURM array, what one run writes."""

import re
import shutil
import stat

import pytest
from recipes import block

WHOLE = "motionedit edit-pc data/golf -m out/golf.npz -s configs/golf-edit.yaml -o whole -q --report whole.json"


@pytest.fixture
def text(root):
    return (root / "docs" / "batches.md").read_text(encoding="utf-8")


def clips_in(folder):
    return {path.name: path.read_bytes() for path in folder.glob("*.bvh")}


@pytest.mark.compiled
@pytest.mark.skipif(shutil.which("make") is None, reason="no make on this machine")
def test_make_and_a_slurm_array_write_what_one_run_writes(text, shell, tmp_path):
    (tmp_path / "golf.mk").write_text(block(text, "make", "golf.mk"), encoding="utf-8")
    code, printed = shell("make -f golf.mk -j 2")
    assert code == 0, printed
    assert len(re.findall(r"^out/edited/", printed, re.MULTILINE)) == 10
    assert shell(WHOLE)[0] == 0
    whole = clips_in(tmp_path / "whole")
    assert clips_in(tmp_path / "out" / "edited") == whole
    assert len(whole) == 10
    report = (tmp_path / "out" / "edited.json").read_text().replace("out/edited/", "whole/")
    assert report == (tmp_path / "whole.json").read_text()

    shutil.rmtree(tmp_path / "out" / "edited")
    script = block(text, "sh", "golf.sbatch")
    job = tmp_path / "golf.sbatch"
    job.write_text(script, encoding="utf-8")
    job.chmod(stat.S_IRWXU)
    first, last = map(int, re.search(r"--array=(\d+)-(\d+)", script).groups())
    for task in range(first, last + 1):
        code, printed = shell("./golf.sbatch", SLURM_ARRAY_TASK_ID=str(task), SLURM_CPUS_PER_TASK="2")
        assert code == 0, printed
    assert clips_in(tmp_path / "out" / "edited") == whole
