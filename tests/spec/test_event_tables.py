"""CSV files of event frames, named by a spec."""

import pytest

SPEC = "events: {hit: {frames: hits.csv}}"


@pytest.fixture
def table(tmp_path):
    def write(text):
        data = text if isinstance(text, bytes) else text.encode()
        (tmp_path / "hits.csv").write_bytes(data)

    return write


@pytest.mark.parametrize(
    "text",
    [
        "clip,frame\nswing01,88\nsub/swing02.bvh,93\n",
        "clip,frame\r\nswing01,88\r\n\r\nsub/swing02.bvh,93",
        "\ufeffclip , frame\n swing01 , 88\nsub/swing02.bvh,0093\n",
        '"clip","frame"\n"swing01","88"\n"sub/swing02.bvh","93"\n',
    ],
)
def test_a_table_gives_the_frame_of_each_clip(text, table, load):
    table(text)
    loaded = load(SPEC, "normalize")
    assert loaded.model.events["hit"].frames.by_clip == {"swing01": 88, "sub/swing02.bvh": 93}
    assert [path.name for path in loaded.files] == ["spec.yaml", "hits.csv"]
    assert loaded.data["events"] == {"hit": {"frames": "hits.csv"}}


def test_a_clip_may_have_a_comma_in_its_name(table, load):
    table('clip,frame\n"swing, slow",3\n')
    assert load(SPEC, "normalize").model.events["hit"].frames.by_clip == {"swing, slow": 3}


def test_a_table_of_no_clips_is_no_fault(table, load):
    table("clip,frame\n")
    assert load(SPEC, "normalize").model.events["hit"].frames.by_clip == {}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ["hits.csv:1: the first line must be clip,frame, not an empty file"]),
        ("swing01,88\n", ["hits.csv:1: the first line must be clip,frame, not 'swing01,88'"]),
        ("\nclip;frame\n", ["hits.csv:2: the first line must be clip,frame, not 'clip;frame'"]),
        (
            "clip,frame\na,x\nb,-1\nc,1.5\nd\n,3\ne,1,2\na,9999999999\n",
            [
                "hits.csv:2: frame must be a whole number of at least 0, not 'x'",
                "hits.csv:3: frame must be a whole number of at least 0, not '-1'",
                "hits.csv:4: frame must be a whole number of at least 0, not '1.5'",
                "hits.csv:5: has 1 values; a row is clip,frame",
                "hits.csv:6: needs a clip before the comma",
                "hits.csv:7: has 3 values; a row is clip,frame",
                "hits.csv:8: frame must be a whole number of at least 0, not '9999999999'",
            ],
        ),
        ("clip,frame\na,1\nb,2\na,3\n", ["hits.csv:4: clip 'a' is listed twice, on lines 2 and 4"]),
        ('clip,frame\n"a,1\n', ["hits.csv:2: not CSV: unexpected end of data"]),
        (b"clip,frame\n\xe9,1\n", ["hits.csv:2: not UTF-8 text; save it as UTF-8"]),
        (b"clip,frame\n\x00", ["spec.yaml:2: events.hit.frames: cannot read 'hits.csv': a binary file, not text"]),
    ],
)
def test_a_faulty_table_is_answered_with_its_own_lines(text, expected, table, messages):
    table(text)
    assert messages(SPEC, "normalize") == expected


def test_a_missing_table_is_a_fault_of_the_spec(messages):
    assert messages(SPEC, "normalize") == ["spec.yaml:2: events.hit.frames: cannot read 'hits.csv': no such file"]


def test_faults_of_the_table_come_after_those_of_the_spec(table, messages):
    table("clip,frame\na,x\n")
    assert messages(f"{SPEC}\nframes: 1\n", "normalize") == [
        "spec.yaml:3: frames: must be at least 2, not 1",
        "hits.csv:2: frame must be a whole number of at least 0, not 'x'",
    ]


def test_a_table_beside_a_spec_in_another_folder_is_named_from_here(tmp_path, monkeypatch):
    from motionedit.errors import MotionEditError
    from motionedit.spec.load import load_spec

    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "configs"
    folder.mkdir()
    (folder / "golf.yaml").write_text(f"schema: motionedit/normalize/v1\n{SPEC}\n")
    (folder / "hits.csv").write_text("clip,frame\na,x\n")
    with pytest.raises(MotionEditError) as caught:
        load_spec((folder / "golf.yaml").relative_to(tmp_path), "normalize")
    (error,) = caught.value.errors
    assert str(error) == "configs/hits.csv:2: frame must be a whole number of at least 0, not 'x'"


def test_more_events_than_a_clip_can_be_asked_for_are_refused(messages):
    events = ", ".join(f"e{i}: {i}" for i in range(1001))
    assert messages(f"events: {{{events}}}", "normalize") == [
        "spec.yaml:2: events: are 1001; one spec has 1000 at most: they are asked for together"
    ]
