"""Results come in the items' order from any number of workers, and workers do not outlive their run."""

import contextlib
import json
import math
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import time
from collections import deque
from functools import partial

import pytest

from motionedit.errors import UsageError
from motionedit.jobs.batch import processes
from motionedit.jobs.batch.no_result import WorkerDiedError
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.batch.pool import results_as_they_come, results_in_order, standing_crew


def slow_first(item):
    time.sleep(0.2 if item == 0 else 0.0)
    return item * item


def die_at_one(item):
    if item == 1:
        os._exit(9)
    return item


def die_at_sixty(item):
    if item == 60:
        os._exit(9)
    return item


def take_a_while(item):
    time.sleep(2.0 * processes._SECONDS_A_MESSAGE)
    return item


def first_letter(item):
    return item[0]


def refuse_sixty(item):
    if item == 60:
        raise ValueError(item)
    return item


def mark(folder, item):
    (folder / str(item)).touch()
    time.sleep(0.02)
    return item


def process_and_item(item):
    return os.getpid(), item


def process_and_double(item):
    return os.getpid(), 2 * item


def interrupt_itself(item):
    os.kill(os.getpid(), signal.SIGINT)
    return item


@pytest.mark.parametrize("jobs", [0, 1, 2, 3])
def test_results_are_in_order_for_any_number_of_workers(jobs):
    found = list(results_in_order(slow_first, range(6), options=RunOptions(jobs=jobs)))
    assert found == [0, 1, 4, 9, 16, 25]


@pytest.mark.parametrize("jobs", [1, 2])
def test_results_that_came_together_come_in_one_list(jobs):
    found = list(results_as_they_come(abs, range(400), options=RunOptions(jobs=jobs)))
    assert [value for come in found for value in come] == list(range(400))
    assert all(found)
    assert len(found) == 400 if jobs == 1 else len(found) < 200


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_error_is_raised_after_the_results_before_it(jobs):
    results, found = results_in_order(refuse_sixty, range(200), options=RunOptions(jobs=jobs)), []
    with pytest.raises(ValueError, match="60"):
        found.extend(results)
    assert found == list(range(60))


def test_one_item_needs_no_worker():
    assert list(results_in_order(os.getppid, [], options=RunOptions(jobs=2))) == []
    assert list(results_in_order(lambda _: os.getpid(), [0], options=RunOptions(jobs=2))) == [os.getpid()]


def test_a_worker_that_dies_is_a_value_and_no_traceback():
    found = list(results_in_order(die_at_one, [1, 1], options=RunOptions(jobs=2)))
    assert [type(value) for value in found] == [WorkerDiedError] * 2
    assert "worker process was killed" in str(found[0])


def test_ctrl_c_is_the_parents_to_answer():
    assert list(results_in_order(interrupt_itself, [1, 2, 3], options=RunOptions(jobs=2))) == [1, 2, 3]


@pytest.mark.parametrize("jobs", [1, 2])
def test_after_the_last_result_that_is_wanted_nothing_is_begun_and_nothing_begun_is_lost(tmp_path, jobs):
    found = list(
        results_in_order(
            partial(mark, tmp_path), range(40), options=RunOptions(jobs=jobs), is_last=lambda value: value == 1
        )
    )
    assert found == list(range(len(found)))
    assert sorted(int(path.name) for path in tmp_path.iterdir()) == found
    assert len(found) < 40
    assert jobs > 1 or len(found) == 2


def test_workers_are_only_a_few_items_ahead_of_the_results_that_are_taken(tmp_path):
    results = results_in_order(partial(mark, tmp_path), range(200), options=RunOptions(jobs=2))
    with contextlib.closing(results):
        assert next(results) == 0
        time.sleep(2.0)  # time for a hundred items in each worker
        begun = len(list(tmp_path.iterdir()))
        assert begun <= 2 * processes.AHEAD
        assert [next(results) for _ in range(100)] == list(range(1, 101))


def test_every_item_after_a_death_is_a_value_too():
    found = list(results_in_order(die_at_one, [1] * 100, options=RunOptions(jobs=2)))
    assert [type(value) for value in found] == [WorkerDiedError] * 100


def test_a_worker_that_dies_of_one_of_several_items_loses_that_one_alone():
    found = list(results_in_order(die_at_sixty, range(200), options=RunOptions(jobs=2)))
    assert [place for place, value in enumerate(found) if isinstance(value, WorkerDiedError)] == [60]
    assert [value for value in found if not isinstance(value, WorkerDiedError)] == [i for i in range(200) if i != 60]


@pytest.fixture
def messages(monkeypatch):
    """How many items each message had, and its bytes, in the order in which they were sent."""
    sent = []

    def noted(items):
        message = pickle.dumps(items)
        sent.append((len(items), len(message)))
        return message

    monkeypatch.setattr(processes, "_packed", noted)
    return sent


def test_short_items_go_in_messages_that_are_full_but_for_the_last_ones(messages):
    assert list(results_in_order(math.isqrt, [9] * 1600, options=RunOptions(jobs=2))) == [3] * 1600
    assert max(count for count, _ in messages) == processes._AT_ONCE
    assert sum(count for count, _ in messages) == 1600
    assert len(messages) < 1.4 * 1600 / processes._AT_ONCE


def test_items_that_take_long_go_one_by_one(messages):
    assert list(results_in_order(take_a_while, range(20), options=RunOptions(jobs=2))) == list(range(20))
    assert [count for count, _ in messages] == [1] * 20


def test_messages_stay_small_enough_for_the_pipe(messages):
    items = [letter * (processes._MOST_BYTES // 3) for letter in "abcdefghij" * 10]
    assert list(results_in_order(first_letter, items, options=RunOptions(jobs=2))) == list("abcdefghij" * 10)
    assert max(count for count, _ in messages) == 2
    assert max(size for _, size in messages) <= processes._MOST_BYTES


def test_closing_early_leaves_no_worker():
    results = results_in_order(slow_first, range(50), options=RunOptions(jobs=2))
    with contextlib.closing(results):
        next(results)
    assert multiprocessing.active_children() == []


def test_a_standing_crew_takes_another_function_and_ends_with_its_context():
    options = RunOptions(jobs=2)
    with standing_crew(options) as crew:
        first = list(results_in_order(process_and_item, range(8), options=options, crew=crew))
        second = list(results_in_order(process_and_double, range(8), options=options, crew=crew))
        assert [item for _, item in first] == list(range(8))
        assert [item for _, item in second] == list(range(0, 16, 2))
        assert {process for process, _ in second} <= {process for process, _ in first} - {os.getpid()}
    assert multiprocessing.active_children() == []


def test_a_worker_of_a_standing_crew_gets_what_it_had_before_and_then_what_others_have_no_time_for():
    crew, (one, other) = processes.Crew(name_of=str.casefold), (object(), object())

    def taken(items, worker, waiting, *, most, before=6):
        return [items[place] for place in crew._take(worker, items, waiting, most=most, before=before)]

    first, again = deque(range(6)), deque(range(6))
    assert taken("abcdef", one, first, most=2) == ["a", "b"]
    assert taken("abcdef", other, first, most=2) == ["c", "d"]
    assert taken("abcdef", one, first, most=2, before=5) == ["e"]
    assert taken("ABCDEF", other, again, most=3) == ["C", "D"]
    assert taken("ABCDEF", other, again, most=3) == ["A", "B", "E"]
    assert (list(first), list(again)) == ([5], [5])


def test_a_standing_crew_that_loses_a_worker_gives_all_results_in_order_though_workers_have_items_of_their_own():
    options = RunOptions(jobs=2)
    with standing_crew(options, name_of=lambda item: item // 16) as crew:
        assert list(results_in_order(slow_first, range(100), options=options, crew=crew))[-1] == 99 * 99
        found = list(results_in_order(die_at_sixty, range(100), options=options, crew=crew))
    assert [value for value in found if not isinstance(value, WorkerDiedError)] == [n for n in range(100) if n != 60]


def test_a_standing_crew_that_was_left_in_the_middle_or_died_begins_anew():
    options = RunOptions(jobs=2)
    with standing_crew(options) as crew:
        with contextlib.closing(results_in_order(slow_first, range(50), options=options, crew=crew)) as results:
            next(results)
        assert multiprocessing.active_children() == []
        found = list(results_in_order(die_at_one, [1, 1, 1], options=options, crew=crew))
        assert [type(value) for value in found] == [WorkerDiedError] * 3
        assert list(results_in_order(slow_first, range(6), options=options, crew=crew)) == [0, 1, 4, 9, 16, 25]


def test_workers_that_are_started_anew_give_the_same_results(monkeypatch):
    monkeypatch.setattr(processes.sys, "platform", "darwin")
    assert list(results_in_order(math.isqrt, [16, 9, 4], options=RunOptions(jobs=2))) == [4, 3, 2]


def test_a_batch_of_workers_that_are_started_anew_writes_the_same_bytes(clip, run, monkeypatch, tmp_path):
    spec = tmp_path / "lift.yaml"
    lift = {"type": "position", "effector": "LeftForeArm", "points": [{"at": 4, "shift": [0, 2, 0]}]}
    spec.write_text(json.dumps({"schema": "motionedit/edit-prioritized/v1", "constraints": [lift]}), encoding="utf-8")
    clips = [clip(f"in/{seed}.bvh", seed=seed) for seed in range(2)]
    assert run("edit-prioritized", "in", "-s", spec, "-o", "one").exit_code == 0
    monkeypatch.setattr(processes.sys, "platform", "darwin")
    assert run("edit-prioritized", "in", "-s", spec, "-o", "two", "-j", "2").exit_code == 0
    for path in clips:
        written = (tmp_path / "one" / path.name).read_bytes()
        assert (tmp_path / "two" / path.name).read_bytes() == written != path.read_bytes()


def test_a_wait_for_a_result_is_many_short_ones_so_that_ctrl_c_is_heard_in_between(monkeypatch):
    monkeypatch.setattr(processes, "SECONDS_WITHOUT_CTRL_C", 0.01)
    assert list(results_in_order(slow_first, range(2), options=RunOptions(jobs=2))) == [0, 1]


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="the system has no such signal")
def test_workers_end_when_their_parent_is_killed():
    code = """
import os, time
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.batch.pool import results_in_order, standing_crew
def work(item):
    os.write(1, f"{os.getpid()}\\n".encode())
    time.sleep(60)
list(results_in_order(work, range(2), options=RunOptions(jobs=2)))
"""
    parent = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    workers = [int(parent.stdout.readline()) for _ in range(2)]
    parent.send_signal(signal.SIGKILL)
    # The pipe closes when the last process that holds it ends.
    assert parent.communicate(timeout=20)[0] == ""
    for worker in workers:
        with pytest.raises(ProcessLookupError):
            _wait_until_gone(worker)


def _wait_until_gone(process):
    for _ in range(100):
        os.kill(process, 0)
        time.sleep(0.05)


def test_a_cluster_needs_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'motionedit\[cluster\]'"):
        list(results_in_order(slow_first, [1], options=RunOptions(scheduler="tcp://127.0.0.1:1")))
