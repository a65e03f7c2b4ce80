"""Normalizing and fitting the golf swings: which clips make a database, what a run refuses and what it says."""

import json
from pathlib import Path

import numpy as np

from motionedit.core.bvh import read_clip, resampled_bytes
from motionedit.core.motion import Motion
from motionedit.core.pca import streaming, vectors
from motionedit.core.pca.model_file import read_model
from motionedit.jobs.fit_pca import asked as fit_pca


def changed_copy(data, path, *, rate=1, scale=1.0):
    """Write swing01 at a share of its rate, or with another scale."""
    from dataclasses import replace

    clip = read_clip(data / "swing01.bvh")
    motion = clip.motion
    skeleton = replace(motion.skeleton, offsets=motion.skeleton.offsets * scale)
    motion = Motion(skeleton, motion.rotations[::rate], motion.translations[::rate] * scale, motion.frame_time * rate)
    path.parent.mkdir(exist_ok=True, parents=True)
    path.write_bytes(resampled_bytes(clip, motion))
    return path


def test_rates_that_differ_need_a_frame_rate(run, configs, data, tmp_path):
    changed_copy(data, tmp_path / "in" / "slow.bvh", rate=2)
    (tmp_path / "in" / "swing01.bvh").write_bytes((data / "swing01.bvh").read_bytes())
    arguments = ("normalize", "in", "-s", configs / "golf-normalize.yaml", "-o", "n")
    result = run(*arguments)
    assert result.exit_code == 2
    assert "frame_rate: the clips' rates differ: in/slow.bvh has 12.5 Hz" in result.stderr
    assert "set frame_rate: 12.5" in result.stderr
    assert not (tmp_path / "n").exists() or not list((tmp_path / "n").iterdir())
    assert run(*arguments, "--set", "frame_rate=12.5").exit_code == 0


def test_normalize_fails_as_a_whole_unless_told_to_keep_going(run, configs, data, clip, tmp_path):
    clip("in/other.bvh", frames=40)
    for name in ("swing01.bvh", "swing02.bvh"):
        (tmp_path / "in" / name).write_bytes((data / name).read_bytes())
    arguments = ("normalize", "in", "-s", configs / "golf-normalize.yaml", "-o", "n")
    result = run(*arguments)
    assert result.exit_code == 1
    assert not (tmp_path / "n" / "normalization.json").exists()
    nothing = "nothing was written, because each clip shifts the means; --keep-going leaves out those that fail"
    assert result.stderr.splitlines()[-1] == f"motionedit: error: {nothing}"
    result = run(*arguments, "--keep-going")
    assert result.exit_code == 1
    assert nothing not in result.stderr
    listing = json.loads((tmp_path / "n" / "normalization.json").read_text())
    assert [each["clip"] for each in listing["clips"]] == ["swing01.bvh", "swing02.bvh"]


def test_update_leaves_a_finished_normalization_alone(run, configs, data):
    arguments = ("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", "n", "--update")
    assert run(*arguments).stdout.count("\n") == 10
    again = run(*arguments)
    assert (again.exit_code, again.stdout) == (0, "")
    assert "10 up to date" in again.stderr


def test_one_clip_is_normalized_with_a_warning_but_is_no_database(run, configs, data):
    result = run("normalize", data / "swing01.bvh", "-s", configs / "golf-normalize.yaml", "-o", "n")
    assert result.exit_code == 0
    assert "is the only clip" in result.stderr
    fit = run("fit-pca", "n", "-o", "m.npz")
    assert fit.exit_code == 2
    assert "lists 1 clip; a PCA needs two or more" in fit.stderr


def test_a_fit_overwrites_none_of_its_inputs(run, configs, data, tmp_path):
    assert run("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", "n").exit_code == 0
    for name in ("n/normalization.json", "n/swing01.bvh"):
        before = (tmp_path / name).read_bytes()
        fit = run("fit-pca", "n", "-o", name)
        assert fit.exit_code == 2
        assert "an input is never overwritten" in fit.stderr
        assert (tmp_path / name).read_bytes() == before


def test_many_clips_are_streamed_and_the_fit_says_so(run, configs, data, tmp_path, monkeypatch):
    run("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", "n")
    held = run("fit-pca", "n", "-o", "held.npz", "--report", "held.json")
    assert "streamed" not in held.stderr
    monkeypatch.setattr(vectors, "MOST_IN_MEMORY", 9)
    fit = run("fit-pca", "n", "-o", "m.npz", "--report", "r.json")
    assert fit.exit_code == 0
    assert "10 clips, streamed from a scratch file: the first 9 components (set components or" in fit.stderr
    report, other = (json.loads((tmp_path / name).read_text()) for name in ("r.json", "held.json"))
    assert report["streamed"]["residual"] < 1e-8
    assert "streamed" not in other
    np.testing.assert_allclose(report["explained_variance"], other["explained_variance"], rtol=1e-9)
    ours, theirs = (read_model(tmp_path / name).components for name in ("m.npz", "held.npz"))
    np.testing.assert_allclose(ours.components, theirs.components, atol=1e-7)


def test_components_that_many_clips_cannot_have_are_refused_or_told(run, configs, data, tmp_path, monkeypatch):
    run("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", "n")
    spec = tmp_path / "f.yaml"
    for most in (1000, 4):
        for module in (streaming, fit_pca):
            monkeypatch.setattr(module, "MOST_COMPONENTS", most)
        monkeypatch.setattr(vectors, "MOST_IN_MEMORY", 9)
        spec.write_text("schema: motionedit/fit-pca/v1\ncomponents: 12\n")
        fit = run("fit-pca", "n", "-o", "m.npz", "-s", spec)
        assert fit.exit_code == 2
        wanted = "10 clips have 9 components" if most == 1000 else "of 10 clips at most 4 components are kept"
        assert f"f.yaml:2: components: {wanted}, not 12" in fit.stderr
    spec.write_text("schema: motionedit/fit-pca/v1\nexplained_variance: 0.99\n")
    fit = run("fit-pca", "n", "-o", "m.npz", "-s", spec)
    assert fit.exit_code == 0
    assert "the first 4 components explain" in fit.stderr
    assert "% of the variance, not 99 %" in fit.stderr


def test_clips_that_cannot_be_used_are_all_named_and_there_is_no_model(run, configs, data, tmp_path):
    run("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", "n")
    for name in ("swing01", "swing07"):
        (tmp_path / "n" / f"{name}.bvh").write_text("HIERARCHY\n")
    fit = run("fit-pca", "n", "-o", "m.npz")
    assert fit.exit_code == 1
    assert "swing01.bvh" in fit.stderr
    assert "swing07.bvh" in fit.stderr
    assert not (tmp_path / "m.npz").exists()


def test_equal_clips_are_no_database(run, configs, data, tmp_path):
    (tmp_path / "in").mkdir()
    for name in ("a.bvh", "b.bvh"):
        (tmp_path / "in" / name).write_bytes((data / "swing01.bvh").read_bytes())
    assert run("normalize", "in", "-s", configs / "golf-normalize.yaml", "-o", "n").exit_code == 0
    fit = run("fit-pca", "n", "-o", "m.npz")
    assert fit.exit_code == 2
    assert "the motions are all the same" in fit.stderr
    assert not (tmp_path / "m.npz").exists()


def test_events_come_from_a_table_and_a_clip_that_has_none_is_named(run, data, tmp_path):
    table = "clip,frame\n" + "".join(f"swing{n:02d},{90 + n}\n" for n in range(1, 10))
    (tmp_path / "hits.csv").write_text(table)
    spec = tmp_path / "n.yaml"
    spec.write_text("schema: motionedit/normalize/v1\nevents:\n  hit: {frames: hits.csv}\n")
    result = run("normalize", data, "-s", spec, "-o", "n")
    assert result.exit_code == 1
    assert f"no frame for {data / 'swing10.bvh'}; add it to frames, or give detect" in result.stderr


def test_a_clip_that_is_like_one_of_the_database_is_told_why_it_is_none(run, data, tmp_path):
    frames = "{swing01: 91, swing02: 87, swing03: 96}"
    (tmp_path / "n.yaml").write_text(f"schema: motionedit/normalize/v1\nevents: {{hit: {{frames: {frames}}}}}\n")
    clips = [data / f"swing0{n}.bvh" for n in (1, 2, 3)]
    assert run("normalize", *clips, "-s", "n.yaml", "-o", "n").exit_code == 0
    assert run("fit-pca", "n", "-o", "m.npz").exit_code == 0
    goal = "{at: hit, effector: {end_site: Club}, shift: [0, 0, 1]}"
    (tmp_path / "e.yaml").write_text(f"schema: motionedit/edit-pc/v1\ngoals: [{goal}]\n")
    (tmp_path / "copy.bvh").write_bytes(clips[1].read_bytes())
    (tmp_path / "swing03.bvh").write_bytes((data / "swing04.bvh").read_bytes())
    for name, why in (
        ("copy", ": it has the bytes of the database's 'swing02' under another name; a clip is known by"),
        ("swing03", ": it has the name of the database's 'swing03' and other bytes; a clip is known by"),
        (data / "swing05", "; give it in the spec, as"),
    ):
        done = run("edit-pc", f"{name}.bvh", "-m", "m.npz", "-s", "e.yaml", "-o", "o.bvh")
        assert done.exit_code == 1
        assert f"no frame for the model's event 'hit'{why}" in done.stderr
        assert f"events: {{hit: {{frames: {{{Path(name).name}: FRAME}}}}}}" in done.stderr
    assert run("edit-pc", clips[1], "-m", "m.npz", "-s", "e.yaml", "-o", "o.bvh").exit_code == 0


def test_normalize_warns_of_an_event_at_the_edge_of_its_window_and_of_a_clip_of_another_length(run, data, tmp_path):
    clip = read_clip(data / "swing02.bvh")
    long = Motion(clip.motion.skeleton, clip.motion.rotations, clip.motion.translations, 3.0 * clip.motion.frame_time)
    (tmp_path / "long.bvh").write_bytes(resampled_bytes(clip, long))
    rule = {"effector": {"end_site": "Club"}, "minimum_of": "height", "between": ["40%", "60%"]}
    spec = {"schema": "motionedit/normalize/v1", "frame_rate": 8, "events": {"hit": {"detect": rule}}}
    (tmp_path / "n.yaml").write_text(json.dumps(spec))
    clips = (data / "swing01.bvh", data / "swing03.bvh", tmp_path / "long.bvh")
    result = run("normalize", *clips, "-s", "n.yaml", "-o", "n")
    assert result.exit_code == 0
    lines = result.stderr.splitlines()
    assert any("swing01.bvh" in line and "'hit' lies at the edge of its window" in line for line in lines)
    assert any("long.bvh' lasts 14.5 s, the others about" in line for line in lines)


def test_nothing_is_left_where_a_crop_ends_before_it_begins(run, data, tmp_path):
    (tmp_path / "n.yaml").write_text("schema: motionedit/normalize/v1\nfrom: 60%\nto: 40%\n")
    result = run("normalize", data / "swing01.bvh", "-s", "n.yaml", "-o", "n")
    assert result.exit_code == 1
    assert "nothing is left from frame 77 (from:) to frame 51 (to:)" in result.stderr
    assert not (tmp_path / "n").exists()
