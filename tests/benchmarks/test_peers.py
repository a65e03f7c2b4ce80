"""The jobs that peers are given say what ours is, and the tables hold whatever comes back."""

from types import SimpleNamespace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.peers import jobs, others, protocol, tables, whole_body

WAY = jobs.Way("points", 1.0, 0.1)


@pytest.fixture(scope="module")
def reach():
    return jobs.reach()


@pytest.fixture(scope="module")
def written(reach, tmp_path_factory):
    folder = tmp_path_factory.mktemp("job")
    jobs.write(reach, folder, WAY, seconds=0.0)
    return folder


def numbers(element, key):
    return np.array(element.get(key).split(), dtype=float)


def evaluated(robot, configuration):
    """Return the places of all bodies by name, and the center of mass, of an MJCF at [place, quaternions x y z w]."""
    places, moment, mass = {}, np.zeros(3), 0.0
    turns = iter(Rotation.from_quat(configuration[3:].reshape(-1, 4)))

    def visit(body, turn, place):
        nonlocal moment, mass
        kind = body.find("joint").get("type")
        assert kind == ("ball" if places else "free")
        place = configuration[:3] if kind == "free" else place + turn.apply(numbers(body, "pos"))
        turn = turn * next(turns)
        places[body.get("name")] = place
        inertial = body.find("inertial")
        moment += float(inertial.get("mass")) * (place + turn.apply(numbers(inertial, "pos")))
        mass += float(inertial.get("mass"))
        for child in body.findall("body"):
            visit(child, turn, place)

    visit(ET.parse(robot).find("worldbody/body"), Rotation.identity(), np.zeros(3))  # noqa: S314
    assert next(turns, None) is None
    return places, moment / mass


@pytest.mark.parametrize("frame", [0, 69, 144])
def test_the_robot_that_peers_read_stands_where_our_kinematics_has_it(written, frame):
    job = protocol.read_job(written)
    places, center = evaluated(job.robot, job.configurations((1, 2, 3, 0))[frame])
    assert list(places) == list(job.names)
    found = [center if j == protocol.COM else places[job.names[j]] for j in job.joints]
    # The joints without mass weigh a trifle there.
    assert np.allclose(found, job.start[frame], atol=1e-7)


def test_the_job_is_31_joints_96_degrees_of_freedom_and_six_tasks_in_three_levels(written):
    job = protocol.read_job(written)
    assert 3 * len(job.names) + 3 == 96
    assert job.levels == (0, 0, 0, 0, 1, 2)
    assert job.joints[-1] == jobs.COM == protocol.COM
    assert job.targets.shape == (145, 6, 3)


def test_our_edit_meets_the_targets_that_peers_are_given(reach):
    alone = jobs.reach_alone(reach)
    assert len(alone.motion) == np.count_nonzero(reach.active[:, 4])
    assert np.nanmax(alone.errors(alone.solve())) < 1e-6
    assert np.abs(alone.targets[:, 4] - reach.targets[reach.active[:, 4], 4]).max() == 0.0


def test_the_contradiction_between_heel_and_toe_is_a_tenth_of_a_millimetre(reach):
    job = jobs.contradicting(reach)
    foot = np.linalg.norm(job.motion.skeleton.offsets[job.joints[1]])
    apart = np.linalg.norm(job.targets[:, 1] - job.targets[:, 0], axis=1)
    assert np.allclose(apart - foot, 1e-4, atol=1e-12)
    assert len(job.constraints) == 5


def test_a_foot_as_one_frame_leaves_its_toe_out(reach, tmp_path):
    jobs.write(reach, tmp_path, jobs.Way("frames", 0.1, 0.0), seconds=0.0)
    job = protocol.read_job(tmp_path)
    assert job.kinds == ["frame", "none", "frame", "none", "point", "com"]
    assert [job.exact(i) for i in range(6)] == [True] * 4 + [False] * 2
    assert job.costs == pytest.approx([1, 1, 1, 1, 0.1, 0.01])


class Halving:
    """A peer that halves the way to the targets with each step, and has no step at frame 3."""

    def __init__(self, job):
        self.job, self.frame, self.now = job, 0, None

    def begin(self, frame):
        self.frame, self.now = frame, self.job.start[frame].copy()

    def step(self):
        if self.frame == 3:
            raise protocol.SolveError
        self.now = 0.5 * (self.now + self.job.targets[self.frame])

    def places(self):
        return self.now


def test_a_frame_is_iterated_until_its_tasks_are_met(written):
    job = protocol.read_job(written)
    outcome = protocol.solve_clip(Halving(job), job)
    far = np.linalg.norm(job.targets - job.start, axis=2).max(axis=1)
    steps = np.maximum(np.ceil(np.log2(np.maximum(far, 1e-9) / job.tolerance)), 1)
    steps[3] = 1
    assert outcome.iterations.tolist() == steps.tolist()
    assert np.flatnonzero(outcome.failed).tolist() == [3]
    assert np.nanmax(outcome.errors) < job.tolerance
    assert np.isnan(outcome.errors).tolist() == (~job.active).tolist()


def test_a_peer_that_is_not_installed_has_its_row(reach, tmp_path, monkeypatch):
    monkeypatch.setattr(others, "ENVIRONMENTS", tmp_path)
    rows = whole_body.conflict(jobs.contradicting(reach), tmp_path)
    assert rows[1][:3] == ("motionedit", "0", "0.050")
    assert {row[1] for row in rows[2:]} == {"cannot be installed here"}


def test_the_table_of_rates_says_what_is_missed(reach):
    good = np.where(reach.active, 1e-4, np.nan)
    bad = np.where(reach.active, 2e-3, np.nan)
    once = np.ones(len(good))
    theirs = {
        ("placo", jobs.Way("frames", 1.0, 1e-6)): whole_body.Measured(10.0, good, once, 0),
        ("placo", jobs.Way("no", 0.1, 1e-6)): whole_body.Measured(1e-9, bad, once, 2),
        ("mink", WAY): "cannot be installed here",
    }
    rows = whole_body._speed_table(reach, {"motionedit, hinges": 0.1, "motionedit": 0.2}, theirs)
    assert {len(row) for row in rows} == {len(whole_body.SPEED)}
    assert rows[3][2:7] == ("14", "100.00 x", ">= 15 x", "met", "0")
    assert rows[4][2:7] == ("-", "-", "", "", "145, 2 without a step")
    assert rows[5][2] == "cannot be installed here"


def test_the_page_of_results_is_a_table_under_each_title():
    page = tables.page("2 cores", [("Speed", [("what", "how fast"), ("ours", "1 x")])])
    assert page.endswith("2 cores\n\n## Speed\n\n| what | how fast |\n|---|---|\n| ours | 1 x |\n")


def test_what_a_peer_says_is_its_last_line(tmp_path, monkeypatch):
    monkeypatch.setattr(others, "command", lambda *_: ["python"])
    said = SimpleNamespace(returncode=0, stdout='loading\n{"seconds": 2}\n', stderr="")
    monkeypatch.setattr(others.subprocess, "run", lambda *_, **__: said)
    assert others.ask("placo", tmp_path) == {"seconds": 2}
    said.returncode, said.stderr = 1, "Traceback\nValueError: no\n"
    with pytest.raises(others.PeerError, match="fails: ValueError: no"):
        others.ask("placo", tmp_path)
