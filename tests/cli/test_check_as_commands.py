"""What a command refuses a spec for, check says too: each fault of a table goes through both."""

import pytest
from click.testing import CliRunner
from prioritized_edits import DATA

from motionedit.cli import main

SWINGS = [DATA / "golf" / f"swing0{n}.bvh" for n in (1, 2, 3)]
HAND = "{type: position, effector: LeftHand, points: [{at: 50, shift: [0, 2, 0]}]}"
FOLLOWS = "{type: position, effector: LeftHand, follow: reference}"
HIT = "goals: [{at: hit, effector: Head, shift: [0, 1, 0]}]"
DETECT = "detect: {effector: {end_site: Club}, minimum_of: height"
# By command: the spec after its first line, and where the fault is.
FAULTS = {
    "normalize": [
        ("body: {head: Hed}", "body.head"),
        ("from: 3000", "from"),
        ("events: {hit: 4000}", "events.hit"),
        ("events: {hit: {frames: {swing02: 9}}}", "events.hit"),
        ("events: {hit: {detect: {effector: Clubb, minimum_of: height}}}", "events.hit.detect.effector"),
        (f"events: {{hit: {{{DETECT}, between: [0, 4000]}}}}}}", "events.hit.detect.between"),
        ("events: {hit: {frames: 5, target: 9999}}", "events.hit.target"),
        ("events: {hit: {frames: 5, target: 0}}", "events"),
        ("events: {a: {frames: {swing01: 5, swing02: 50, swing03: 7}}, b: 30}", "events.a"),
    ],
    "fit-pca": [
        ("body: {head: Hed}", "body.head"),
        ("exclude_joints: [Club, Hed]", "exclude_joints.1"),
        ("exclude_joints: [Hips]", "exclude_joints.0"),
        ("components: 3", "components"),
    ],
    "edit-pc": [
        (f"{HIT}\nbody: {{head: Hed}}", "body.head"),
        ("goals: [{at: hit, effector: Hed, shift: [0, 1, 0]}]", "goals.0.effector"),
        ("goals: [{at: hit, effector: Head, relative_to: Hed, shift: [0, 1, 0]}]", "goals.0.relative_to"),
        ("goals: [{at: 5000, effector: Head, shift: [0, 1, 0]}]", "goals.0.at"),
        ("goals: [{at: hit + 300s, effector: Head, shift: [0, 1, 0]}]", "goals.0.at"),
        ("goals: [{at: hitt, effector: Head, shift: [0, 1, 0]}]", "goals.0.at"),
        (f"{HIT}\nevents: {{hit: 4000}}", "events.hit"),
        (f"{HIT}\nevents: {{hit: 0}}", "events.hit"),
        (f"{HIT}\ncomponents: 99", "components"),
        (f"{HIT}\nup: z", "up"),
        (f"{HIT}\nevents: {{top: 30, hti: 80}}", "events.hti"),
    ],
    "edit-prioritized": [
        (f"constraints: [{HAND.replace('LeftHand', 'Hed')}]", "constraints.0.effector"),
        (f"constraints: [{HAND.replace('50', '5000')}]", "constraints.0.points.0.at"),
        (f"constraints: [{HAND.replace('50', 'hit')}]\nevents: {{hit: 4000}}", "events.hit"),
        (
            f"constraints: [{HAND.replace('50', 'hit')}]\nevents: {{hit: {{frames: {{swing02: 9}}}}}}",
            "constraints.0.points.0.at",
        ),
        (f"constraints: [{HAND}]\nbody: {{head: Hed}}", "body.head"),
        (f"constraints: [{HAND}]\nmasses: {{Hed: 3}}", "masses.Hed"),
        (f"constraints: [{HAND}]\nmasses: {{Head: 0}}", "masses"),
        (f"constraints: [{HAND}]\nhinges: [Hed]", "hinges.0"),
        (f"constraints: [{HAND}]\nstiffness: {{Hed: 3}}", "stiffness.Hed"),
        (f"constraints: [{HAND}]\nlimits: {{Hed: {{swing: 3}}}}", "limits.Hed"),
        (f"constraints: [{HAND}]\nreference: {SWINGS[0]}", "reference"),
        (f"constraints: [{FOLLOWS}]", "constraints.0.follow"),
        (f"constraints: [{FOLLOWS}]\nreference: nowhere.bvh", "reference"),
        ("constraints: [{type: footplants, feet: [Head]}]", "constraints.0.feet.0"),
        ("constraints: [{type: footplants, plants: {LeftFoot: [[20, 4000]]}}]", "constraints.0.plants.LeftFoot.0"),
        ("constraints: [{type: position, effector: {end_site: Hips}}]", "constraints.0.effector"),
        ("constraints: [{type: position, effector: Head, recruit: {up_to: LeftHand}}]", "constraints.0.recruit.up_to"),
        (
            (
                "constraints: [{type: position, effector: LeftHand, priority: 2, recruit: {joints: [LeftArm]}}, "
                "{type: position, effector: RightHand, priority: 1}]\nrecruiting_rule: error"
            ),
            "constraints.0.recruit",
        ),
        (
            (
                "constraints: [{type: floor, height: 9999, priority: 1}, "
                "{type: position, effector: LeftFoot, priority: 2}]"
            ),
            "constraints.0.height",
        ),
    ],
}


@pytest.fixture(scope="module")
def database(tmp_path_factory):
    """Return a folder with `n`, the normalized swings, and `m.npz`, the model of them, whose event a rule finds."""
    folder = tmp_path_factory.mktemp("database")
    spec = folder / "n.yaml"
    spec.write_text(f"schema: motionedit/normalize/v1\nevents: {{hit: {{{DETECT}, between: [60%, 85%]}}}}}}\n")
    assert invoke("normalize", *SWINGS, "-s", spec, "-o", folder / "n", "-q").exit_code == 0
    assert invoke("fit-pca", folder / "n", "-o", folder / "m.npz", "-q").exit_code == 0
    return folder


def invoke(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


def lines_of(done):
    return [line for line in (*done.stderr.splitlines(), *done.stdout.splitlines()) if "s.yaml" in line]


@pytest.mark.parametrize(
    ("command", "text", "key"), [(command, *fault) for command, faults in FAULTS.items() for fault in faults]
)
def test_check_refuses_what_the_command_refuses_and_in_its_words(run, tmp_path, database, command, text, key):
    (tmp_path / "s.yaml").write_text(f"schema: motionedit/{command}/v1\n{text}\n")
    clips = sorted((database / "n").glob("*.bvh")) if command == "fit-pca" else SWINGS
    given = [database / "n"] if command == "fit-pca" else clips
    model = ["-m", database / "m.npz"] if command == "edit-pc" else []
    refused = run(command, *given, *model, "-s", "s.yaml", "-o", "out.npz" if command == "fit-pca" else "out")
    checked = run("check", *clips, *model, "-s", "s.yaml")
    assert refused.exit_code in (1, 2)
    assert checked.exit_code in (2, 3)
    line = 2 + next((n for n, row in enumerate(text.splitlines()) if row.startswith(key.split(".")[0])), 0)
    place = f"s.yaml:{line}: {key}: "
    (said,) = [each.partition(place)[2] for each in lines_of(refused) if place in each]
    answers = [each.partition(place)[2] for each in lines_of(checked) if place in each]
    what = said.partition(" (and in ")[0]
    # The clip is named that is the first: of a folder, or of its files.
    assert answers[0].startswith(what.replace(str(database / "n"), str(clips[0])) if command == "fit-pca" else what)
    assert [answer for answer in answers[1:] if not answer.startswith("as above (")] == []
