"""Damaged files of every kind that is read: taken, or refused in plain words; `make fuzz` tries many."""

import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from damage import damaged_bytes, damaged_values
from hypothesis import given, settings
from hypothesis import strategies as st
from mannequin import bvh_text
from strokes import TIMELINE, database, model_of

from motionedit.core.bvh import new_bytes
from motionedit.core.pca.array_file import array_bytes
from motionedit.core.pca.model_file import model_bytes

# Edits of all kinds at once: files are read alike with either solver.
pytestmark = pytest.mark.compiled

HERE = Path(__file__).parent
FUZZ = settings.get_profile("fuzz")
PLAYER = bvh_text(frames=10).encode()
PLAYERS = {f"c/{k}.bvh": bvh_text(frames=10 + k, swing=40.0 + 10.0 * k).encode() for k in range(3)}
BVH_WORDS = [
    *(b"HIERARCHY", b"ROOT x", b"JOINT x", b"End Site", b"{", b"}", b"OFFSET 0 0 0", b"CHANNELS 3", b"CHANNELS 0"),
    *(b"Xposition", b"Wrotation", b"MOTION", b"Frames:", b"Frame Time:", b"\n", b"\r", b"\t", b" ", b"\0", b"\x1a"),
]
SPEC_WORDS = [
    *(
        b"\n",
        b"  ",
        b"- ",
        b": ",
        b"{",
        b"}",
        b"[",
        b"]",
        b"#",
        b"'",
        b'"',
        b"&a ",
        b"*a",
        b"<<: ",
        b"!!python/name:os",
    ),
    *(b"off", b"true", b"null", b"hit", b"hit + 2", b"50%", b"0.1s", b"at: 3", b"hold: [2, 4]", b"during: [2, 4]"),
    *(b"all", b"Head", b"LeftHand", b"{levels: 2}", b"relative_to: Hips", b"weight: 1e-30", b"priority: 10"),
]


def seeds(kind):
    """Return the files of a kind that are kept because they once broke something, or are rare."""
    return [path.read_bytes() for path in sorted((HERE / "seeds" / kind).iterdir())]


BVH, SPECS = [PLAYER, *seeds("bvh")], seeds("spec")
SPEC = SPECS[0]


@pytest.mark.parametrize("data", BVH)
def test_every_clip_that_is_kept_is_taken_or_refused(answer, data):
    answer({"a.bvh": data, "s.yaml": SPEC}, "edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", "b.bvh", "--lenient")


@given(data=damaged_bytes(BVH, BVH_WORDS), command=st.sampled_from(["info", "check", "edit", "copy", "preview"]))
@settings(FUZZ)
def test_clips(answer, data, command):
    files = {"a.bvh": data, "s.yaml": SPEC, "copy.yaml": b"schema: motionedit/edit-prioritized/v1\nconstraints: []\n"}
    edit = ["edit-prioritized", "a.bvh", "-o", "b.bvh", "-s"]
    arguments = {
        "info": ["info", "a.bvh", "--contacts", "--at", "3", "--joint", "LeftHand"],
        "check": ["check", "a.bvh"],
        "edit": [*edit, "s.yaml"],
        "copy": [*edit, "copy.yaml"],
        "preview": ["preview", "a.bvh", "-o", "p.html"],
    }[command]
    result, wrote = answer(files, *arguments)
    assert (result.exit_code == 0) or not wrote
    if command == "copy" and wrote:
        assert wrote["b.bvh"] == data


@pytest.mark.parametrize("data", SPECS)
def test_every_spec_that_is_kept_is_taken_or_refused(answer, data):
    answer({"a.bvh": PLAYER, "s.yaml": data}, "edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", "b.bvh")


def test_the_spec_that_is_damaged_is_whole(answer):
    for data in SPECS[:2]:
        files = {"a.bvh": PLAYER, "s.yaml": data}
        assert answer(files, "edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", "b.bvh")[0].exit_code == 0


@given(data=st.data(), whole=st.booleans())
@settings(FUZZ)
def test_specs(answer, data, whole):
    if whole:
        spec = yaml.safe_dump(data.draw(damaged_values(yaml.safe_load(data.draw(st.sampled_from(SPECS[:2]))))))
        data = spec.encode("utf-8", "surrogatepass")
    else:
        data = data.draw(damaged_bytes(SPECS, SPEC_WORDS))
    files = {"a.bvh": PLAYER, "s.yaml": data}
    options = ["--preview", "--report", "r.json"]
    result, wrote = answer(files, "edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", "b.bvh", *options)
    if result.exit_code == 0:
        answer({**files, "b.bvh": wrote["b.bvh"]}, "info", "b.bvh")
        is_shown(wrote["b.html"])


@pytest.fixture(scope="module")
def model():
    motions, hits = database(4)
    with np.load(io.BytesIO(model_bytes(model_of(motions, TIMELINE, hits)))) as archive:
        arrays = {name: archive[name] for name in archive.files}
    goal = "schema: motionedit/edit-pc/v1\ngoals: [{at: 20, effector: Head, shift: [0, 0.02, 0]}]\nevents: {hit: 36}\n"
    return arrays, {"a.bvh": new_bytes(motions[0]), "s.yaml": goal.encode()}


@st.composite
def damaged_arrays(draw, arrays):
    """Return a model file of which one array, or what is told in words, is otherwise."""
    arrays = dict(arrays)
    name = draw(st.sampled_from(sorted(arrays)))
    array = arrays[name]
    if name == "about":
        about = draw(damaged_values(json.loads(array.tobytes())))
        array = np.frombuffer(json.dumps(about).encode(), np.uint8)
    elif array.size:
        change = draw(st.sampled_from(["value", "value", "all", "shape", "type"]))
        odd = draw(st.sampled_from([0, -1, 1, 3, 1e9, 1e-300, 1e300, np.nan, np.inf]))
        array = array.astype(np.float64)
        if change == "value":
            array.flat[draw(st.integers(0, array.size - 1))] = odd
        elif change == "all":
            array = array * odd if np.isfinite(odd) else array + odd
        elif change == "shape":
            array = draw(st.sampled_from([array[:-1], array.T, array[None], array.ravel()]))
        if arrays[name].dtype.kind == "i" and change != "type":
            array = np.nan_to_num(array, posinf=9e9, neginf=-9e9).clip(-9e9, 9e9).astype(np.int64)
    arrays[name] = array
    return array_bytes(arrays)


@given(data=st.data(), whole=st.booleans())
@settings(FUZZ)
def test_models(answer, model, data, whole):
    arrays, files = model
    found = data.draw(damaged_arrays(arrays) if whole else damaged_bytes([array_bytes(arrays)], [b"PK", b"\0" * 8]))
    answer({**files, "m.npz": found}, "edit-pc", "a.bvh", "-m", "m.npz", "-s", "s.yaml", "-o", "b.bvh")


@pytest.fixture(scope="module")
def normalized(answer):
    spec = b"schema: motionedit/normalize/v1\nevents: {hit: {target: mean, frames: {'0': 5, '1': 5, '2': 6}}}\n"
    _, wrote = answer({**PLAYERS, "n.yaml": spec}, "normalize", "c", "-s", "n.yaml", "-o", "n")
    return wrote


@given(data=st.data(), whole=st.booleans())
@settings(FUZZ)
def test_lists_of_normalized_clips(answer, normalized, data, whole):
    name = "n/normalization.json"
    files = {**normalized, name: draw_json(data, normalized[name], whole=whole)}
    answer(files, "fit-pca", "n", "-o", "m.npz")


@pytest.fixture(scope="module")
def edited(answer):
    files = {"a.bvh": PLAYER, "s.yaml": SPEC}
    _, wrote = answer(files, "edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", "b.bvh", "--report", "r.json")
    return {**files, **wrote}


@given(data=st.data(), whole=st.booleans())
@settings(FUZZ)
def test_reports_given_to_preview(answer, edited, data, whole):
    files = {**edited, "r.json": draw_json(data, edited["r.json"], whole=whole)}
    _, wrote = answer(files, "preview", "a.bvh", "b.bvh", "--report", "r.json", "-o", "p.html")
    if wrote:
        is_shown(wrote["p.html"])


def draw_json(data, text, *, whole):
    """Return JSON that is otherwise, as values or as text."""
    if whole:
        return json.dumps(data.draw(damaged_values(json.loads(text)))).encode()
    return data.draw(damaged_bytes([text], [b"NaN", b"null", b'"', b"[", b"]", b"{", b"}", b",", b":"]))


def is_shown(html):
    """Fail where the data of a page are not what its script can read."""

    def refuse(name):
        raise AssertionError(f"{name} in the page")

    found = re.findall(rb'<script id="\w+" type="application/json">(.*?)</script>', html, re.DOTALL)
    assert len(found) == 2
    for text in found:
        json.loads(text, parse_constant=refuse)


def test_a_page_that_no_script_can_read_is_noticed():
    with pytest.raises(AssertionError):
        is_shown(b'<script id="x" type="application/json">[NaN]</script>' * 2)
