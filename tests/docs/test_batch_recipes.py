"""The recipes of batches.md write, with make, as a SLURM array, and with Snakemake, what one run writes."""

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


@pytest.mark.compiled
@pytest.mark.skipif(shutil.which("snakemake") is None, reason="no snakemake on this machine")
def test_snakemake_writes_what_one_run_writes_and_takes_up_what_is_left(text, shell, tmp_path):
    (tmp_path / "golf.smk").write_text(block(text, "snakemake", "golf.smk"), encoding="utf-8")
    snakemake = "snakemake -s golf.smk --cores 2"
    code, printed = shell(snakemake)
    assert code == 0, printed
    assert shell(WHOLE)[0] == 0
    whole = clips_in(tmp_path / "whole")
    assert clips_in(tmp_path / "out" / "edited") == whole
    assert len(whole) == 10
    report = (tmp_path / "out" / "edited.json").read_text().replace("out/edited/", "whole/")
    assert report == (tmp_path / "whole.json").read_text()
    assert "Nothing to be done" in shell(snakemake)[1]
    (tmp_path / "out" / "shards" / "2.json").unlink()
    code, printed = shell(snakemake)
    assert (code, re.findall(r"^out/edited/", printed, re.MULTILINE)) == (0, []), printed


def test_the_rules_of_snakemake_run_the_lines_of_make(text):
    """Where there is no snakemake: the same commands, on the same files."""
    rules, make = block(text, "snakemake", "golf.smk"), block(text, "make", "golf.mk")
    lines = [" ".join(re.sub(r'" *\n *"', "", part).split()) for part in (rules, make)]
    rules, make = (line.replace("$(MODEL)", "{MODEL}").replace("$@", "{output}") for line in lines)
    for command in (r"edit-pc .*? --update", r"normalize .*? -q", r"fit-pca .*? -q"):
        assert re.search(f"motionedit {command}", make)[0] in rules
    count = len(re.search(r"SHARDS := ([0-9 ]+)", make)[1].split())
    assert f"SHARDS = range(1, {count + 1})" in rules
    assert "--shard {{wildcards.k}}/{len(SHARDS)}" in rules
