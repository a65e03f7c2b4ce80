"""--shard K/N: a batch on several machines comes to what it comes to on one."""

import hashlib
import json
from pathlib import Path

import pytest

from motionedit.errors import UsageError
from motionedit.jobs.batch.shards import Shard, shard_of

NAMES = ["a.bvh", "b.bvh", "c.bvh", "deep/a.bvh", "deep/d.bvh", "two/d.bvh", "é.bvh"]
COUNT = 3


@pytest.fixture
def clips(clip):
    return [clip(f"in/{name}", seed=seed) for seed, name in enumerate(NAMES)]


@pytest.fixture
def edit(run, clips, copy_spec):
    """Return a runner of an edit of all clips, or of a shard of them."""
    del clips

    def go(*more, spec=copy_spec.name, output="out"):
        return run("edit-prioritized", "in", "-s", spec, "-o", output, *more)

    return go


def shard_by_hand(name, count):
    return int(hashlib.sha256(name.encode()).hexdigest(), 16) % count + 1


def names_in(folder):
    return {path.relative_to(folder).as_posix() for path in Path(folder).rglob("*.bvh")}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("count", [1, 2, 16, 1000])
def test_a_clip_belongs_to_one_shard_by_the_sha_256_of_its_name(name, count):
    assert [k for k in range(1, count + 1) if Shard(k, count).has(name)] == [shard_by_hand(name, count)]


def test_the_shards_together_write_what_one_run_writes(edit):
    edit(output="whole")
    for k in range(1, COUNT + 1):
        before = names_in("out")
        done = edit("--shard", f"{k}/{COUNT}", "-j", "2")
        assert done.exit_code == 0, done.stderr
        mine = {name for name in NAMES if shard_by_hand(name, COUNT) == k}
        assert names_in("out") - before == {line.removeprefix("out/") for line in done.stdout.splitlines()} == mine
    assert names_in("out") == set(NAMES)
    assert all(Path("out", name).read_bytes() == Path("whole", name).read_bytes() for name in NAMES)


def test_update_knows_what_shards_made_and_reports_it_all(edit):
    edit("--report", "whole.json")
    verdicts = Path("out/.motionedit-verdicts.jsonl")
    for path in (verdicts, *Path("out").rglob("*.bvh")):
        path.unlink()
    for k in range(1, COUNT + 1):
        edit("--shard", f"{k}/{COUNT}", "--update", "--report", f"{k}.json")
    assert edit("--shard", f"2/{COUNT}", "--update").stdout == ""
    collected = edit("--update", "--report", "all.json")
    assert (collected.exit_code, collected.stdout) == (0, "")
    assert Path("all.json").read_bytes() == Path("whole.json").read_bytes()
    parts = [entry for k in range(1, COUNT + 1) for entry in json.loads(Path(f"{k}.json").read_text())["clips"]]
    assert sorted(entry["clip"] for entry in parts) == [f"in/{name}" for name in sorted(NAMES)]


def test_a_shard_of_one_clip_reports_as_little_of_it_as_the_whole_run(edit):
    ride = "{type: position, effector: LeftForeArm, points: [{at: 4, shift: [0, 1, 0]}]}"
    Path("ride.yaml").write_text(f"schema: motionedit/edit-prioritized/v1\nconstraints: [{ride}]\n")
    alone = shard_by_hand("two/d.bvh", 99)
    assert [name for name in NAMES if shard_by_hand(name, 99) == alone] == ["two/d.bvh"]
    edit("--report", "whole.json", spec="ride.yaml")
    Path("out/two/d.bvh").unlink()
    edit("--shard", f"{alone}/99", spec="ride.yaml")
    assert edit("--update", "--report", "all.json", spec="ride.yaml").stdout == ""
    assert Path("all.json").read_bytes() == Path("whole.json").read_bytes()


def test_another_clip_moves_none(edit, clip):
    def planned():
        lines = edit("--shard", f"2/{COUNT}", "--dry-run").stdout.splitlines()
        return {line.partition(" -> out/")[2] for line in lines if " -> out/" in line}

    before, added = planned(), {f"{n}.bvh" for n in range(8)}
    for name in added:
        clip(f"in/{name}")
    assert before == {name for name in NAMES if shard_by_hand(name, COUNT) == 2} != set()
    assert planned() == before | {name for name in added if shard_by_hand(name, COUNT) == 2} != before


def test_a_shard_without_clips_is_done_and_says_so(edit):
    empty = next(k for k in range(1, 100) if k not in {shard_by_hand(name, 99) for name in NAMES})
    done = edit("--shard", f"{empty}/99", "--report", "r.json", "--strict")
    assert (done.exit_code, done.stdout) == (0, "")
    assert done.stderr == f"no clip belongs to shard {empty}/99: nothing to do\n"
    assert json.loads(Path("r.json").read_text())["clips"] == []
    assert edit("--shard", f"{empty}/99", "-q").stderr == ""


@pytest.mark.parametrize(
    "text", ["", "3", "/4", "4/", "x/4", "-1/4", "1/4/4", "1.0/4", "1/0", " 1/4", "\u0661/4", "1/" + "9" * 5000]
)
def test_what_is_no_shard_is_refused(text):
    with pytest.raises(UsageError, match="no such shard; give K/N, such as 3/16"):
        shard_of(text)


@pytest.mark.parametrize("text", ["0/4", "5/4"])
def test_shards_count_from_1(edit, text):
    done = edit("--shard", text)
    assert done.exit_code == 2
    assert done.stderr == f"motionedit: error: --shard {text}: no such shard; count shards from 1: 1/4 to 4/4\n"
    assert not Path("out").exists()


def test_what_is_wrong_with_all_names_together_every_shard_says(edit, run, clip, copy_spec):
    spec = Path(copy_spec).read_text()
    Path("hits.csv").write_text("clip,frame\nd,3\n")
    Path("hits.yaml").write_text(f"{spec}events: {{hit: {{frames: hits.csv}}}}\n")
    owners = {shard_by_hand("deep/d.bvh", 16), shard_by_hand("two/d.bvh", 16)}
    assert len(owners) == 2, "the two clips that a row may mean are to be in two shards"
    for k in owners:
        assert "'d' may be" in edit("--shard", f"{k}/16", spec="hits.yaml").stderr
    clip("other/a.bvh")
    for k in range(1, 5):
        done = run("edit-prioritized", "in", "other", "-s", copy_spec.name, "-o", "out", "--shard", f"{k}/4")
        assert (done.exit_code, "would both be written to" in done.stderr) == (2, True)


def test_outputs_of_other_shards_may_exist(edit):
    edit("--shard", f"1/{COUNT}")
    assert edit("--shard", f"2/{COUNT}", "--no-overwrite").exit_code == 0
    assert edit("--shard", f"2/{COUNT}", "--no-overwrite").exit_code == 2


@pytest.mark.parametrize(("clips_given", "output"), [("-", "o.bvh"), ("in/a.bvh", "-")])
def test_a_shard_is_of_files(run, clips, copy_spec, clips_given, output):
    stdin = clips[0].read_bytes() if clips_given == "-" else None
    done = run("edit-prioritized", clips_given, "-s", copy_spec.name, "-o", output, "--shard", "1/2", stdin=stdin)
    assert (done.exit_code, done.stdout) == (2, "")
    assert "--shard" in done.stderr


def test_normalize_says_why_it_has_no_shards(run, clip, copy_spec):
    clip("in/a.bvh")
    done = run("normalize", "in", "-s", copy_spec.name, "-o", "out", "--shard", "1/2")
    assert done.exit_code == 2
    assert "--shard: normalize takes all clips together, since each one moves the means" in done.stderr
