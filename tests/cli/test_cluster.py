"""--scheduler: the same run on a Dask cluster of real processes, and what is said of one that cannot do it."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from motionedit.errors import UsageError
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.batch.pool import results_in_order

pytest.importorskip("distributed", reason="needs the extra motionedit[cluster]")

from cluster_processes import Processes

from motionedit.jobs.batch import arrivals, cluster

DATA = Path(__file__).resolve().parents[2] / "data"
CONFIGS = DATA.parent / "configs"
# Dask's own event loops and sockets close late; none of that is ours to judge.
pytestmark = [pytest.mark.filterwarnings("ignore"), pytest.mark.compiled]


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    """Return the address of a cluster with two workers."""
    processes = Processes(tmp_path_factory.mktemp("elsewhere"))
    processes.start_scheduler()
    processes.start_worker()
    processes.start_worker()
    yield processes.address
    processes.end()


@pytest.fixture
def processes(tmp_path_factory):
    """Return a scheduler of this test's own, without workers."""
    started = Processes(tmp_path_factory.mktemp("elsewhere"))
    started.start_scheduler()
    yield started
    started.end()


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(cluster, "SECONDS_TO_CONNECT", 2.0)
    monkeypatch.setattr(cluster, "SECONDS_WITHOUT_WORKERS", 1.0)
    monkeypatch.setattr(arrivals, "SECONDS_TO_ARRIVE", 0.1)


@pytest.fixture
def idle(monkeypatch):
    """Let this process read no clip: workers alone can."""

    def refuse(task, *, lenient):
        pytest.fail(f"{task.label} (lenient: {lenient}) is read here, not by a worker")

    # The first last: the others take theirs from it as they are loaded.
    for module in ("fit_pca.database", "normalize.measures", "edit_prioritized.reference", "batch.one_clip"):
        monkeypatch.setattr(f"motionedit.jobs.{module}.read_task", refuse)


@pytest.fixture
def swings(tmp_path):
    """Return a folder of four swings, with all that the commands need beside it."""
    for n, name in enumerate(("a.bvh", "deep/b.bvh", "c.bvh", "d.bvh"), start=1):
        path = tmp_path / "in" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes((DATA / "golf" / f"swing{n:02d}.bvh").read_bytes())
    for name in ("golf-normalize", "golf-fit", "golf-edit"):
        text = (CONFIGS / f"{name}.yaml").read_text().replace("    frames: ../data/golf/events.csv\n", "")
        (tmp_path / f"{name}.yaml").write_text(text)
    hand = {"type": "position", "effector": "LeftHand", "points": [{"at": 40, "shift": [0, 9, 0]}]}
    spec = {"schema": "motionedit/edit-prioritized/v1", "reference": "in", "constraints": [hand]}
    spec["constraints"].append({"type": "footplants", "priority": 9})
    (tmp_path / "hand.yaml").write_text(json.dumps(spec))
    return "in"


def files_below(folder):
    folder = Path(folder)
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_results_are_the_workers_and_in_order(two):
    tell = "__import__('time').sleep(0.05) or (__import__('os').getpid(), {})"
    found = list(results_in_order(eval, [tell.format(n) for n in range(20)], options=RunOptions(scheduler=two)))
    assert [n for _, n in found] == list(range(20))
    workers = {process for process, _ in found}
    assert len(workers) == 2
    assert os.getpid() not in workers


def test_what_a_function_raises_is_raised_here(two):
    with pytest.raises(ZeroDivisionError):
        list(results_in_order(eval, ["1", "1/0"], options=RunOptions(scheduler=two)))


def test_after_the_last_result_that_is_wanted_nothing_is_begun_and_nothing_begun_is_lost(two, tmp_path):
    begin = f"open('{tmp_path}/{{0}}', 'x').close() or __import__('time').sleep(0.02) or {{0}}"
    items = [begin.format(n) for n in range(60)]
    options = RunOptions(scheduler=two)
    found = list(results_in_order(eval, items, options=options, is_last=lambda value: value == 3))
    assert found == list(range(len(found)))
    assert sorted(int(path.name) for path in tmp_path.iterdir()) == found
    assert len(found) < 20


def test_what_is_common_is_sent_once(two, monkeypatch):
    sent = []
    monkeypatch.setattr(cluster, "packed", lambda value, pack=cluster.packed: sent.append(pack(value)) or sent[-1])
    common = b"x" * 1_000_000
    found = list(results_in_order(common.startswith, [b"x", b"y"] * 20, options=RunOptions(scheduler=two)))
    assert found == [True, False] * 20
    assert len(sent) == 41
    assert sum(map(len, sent)) < 1_100_000


@pytest.mark.usefixtures("swings", "idle")
def test_every_command_writes_what_it_writes_here(two, run, tmp_path, monkeypatch):
    commands = [
        ("normalize", "in", "-s", "golf-normalize.yaml", "-o", "out/n"),
        ("fit-pca", "out/n", "-s", "golf-fit.yaml", "-o", "out/m.npz", "--report", "out/m.json"),
        ("edit-pc", "in", "-m", "out/m.npz", "-s", "golf-edit.yaml", "-o", "out/pc", "--report", "out/pc.json"),
        ("edit-prioritized", "in", "-s", "hand.yaml", "-o", "out/prio", "--preview", "--report", "out/prio.json"),
    ]
    printed = [run(*command, "--scheduler", two, "-q") for command in commands]
    assert [done.exit_code for done in printed] == [0] * 4, [done.stderr for done in printed]
    there = files_below("out")
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    Path("out").rename("there")
    again = [run(*command, "-q") for command in commands]
    assert [(done.stdout, done.stderr) for done in again] == [(done.stdout, done.stderr) for done in printed]
    assert files_below("out") == there
    assert len([path for path in there if path.suffix == ".bvh"]) == 12


@pytest.mark.usefixtures("swings", "impatient")
def test_a_cluster_without_workers_is_an_error_in_words(processes, run):
    done = run("normalize", "in", "-s", "golf-normalize.yaml", "-o", "out", "--scheduler", processes.address)
    assert (done.exit_code, done.stdout) == (1, "")
    start = f"start some: dask worker {processes.address}"
    assert done.stderr == f"motionedit: error: --scheduler {processes.address}: there are no workers; {start}\n"
    assert not Path("out").exists()


@pytest.mark.usefixtures("swings")
@pytest.mark.parametrize(
    ("kind", "environment", "said"),
    [
        ("without", {}, "cannot load motionedit: ModuleNotFoundError"),
        ("fit", {"MOTIONEDIT_SOLVER": "numpy"}, "has motionedit 0.1.0 (numpy solver); here is motionedit 0.1.0 (comp"),
    ],
)
def test_workers_that_would_not_do_the_same_are_refused(processes, run, kind, environment, said):
    processes.start_worker()
    processes.start_worker(kind, **environment)
    done = run("edit-prioritized", "in", "-s", "hand.yaml", "-o", "out", "--scheduler", processes.address)
    assert (done.exit_code, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert said in done.stderr
    assert not Path("out").exists()


@pytest.mark.usefixtures("swings", "impatient")
def test_when_the_last_worker_dies_what_was_done_is_told_and_the_rest_is_done_later(processes, run):
    processes.start_worker("dying")
    edit = ("edit-prioritized", "in", "-s", "hand.yaml", "-o", "out", "--scheduler", processes.address, "-q")
    done = run(*edit, "--report", "r.json")
    assert (done.exit_code, done.stdout) == (1, "out/a.bvh\n")
    lost = f"in/c.bvh: --scheduler {processes.address}: no worker is left; start some, and go on with --update"
    assert done.stderr == f"motionedit: error: {lost} (and in 2 more clips)\n4 clips: 1 ok, 3 failed\n"
    assert [entry["status"] for entry in json.loads(Path("r.json").read_text())["clips"]] == ["ok", *["failed"] * 3]
    processes.start_worker()
    assert run(*edit, "--update").stdout.split() == ["out/c.bvh", "out/d.bvh", "out/deep/b.bvh"]


@pytest.mark.usefixtures("swings")
def test_a_worker_that_dies_of_a_clip_is_no_loss_while_there_are_others(processes, run):
    processes.start_worker("dying")
    processes.start_worker()
    done = run("edit-prioritized", "in", "-s", "hand.yaml", "-o", "out", "--scheduler", processes.address, "-q")
    assert (done.exit_code, len(done.stdout.split())) == (0, 4), done.stderr


@pytest.mark.usefixtures("impatient")
def test_when_the_scheduler_dies_the_run_ends(processes):
    processes.start_worker()
    found = []
    for value in results_in_order(
        eval, ["1", "__import__('time').sleep(60)", "2"], options=RunOptions(scheduler=processes.address)
    ):
        found.append(value)
        processes.scheduler.kill()
    assert found[0] == 1
    assert ["no worker is left" in str(value) for value in found[1:]] == [True, True]


@pytest.mark.usefixtures("swings", "impatient")
def test_outputs_that_are_nowhere_are_failures(processes, run):
    processes.start_worker("elsewhere")
    done = run("edit-prioritized", "in", "-s", "hand.yaml", "-o", "out", "--scheduler", processes.address, "-q")
    assert (done.exit_code, done.stdout) == (1, "")
    missing = "its worker wrote it, but it is not here: give an output that all machines share"
    assert done.stderr.startswith(f"motionedit: error: out/a.bvh: {missing}\n")
    assert done.stderr.endswith("4 clips: 4 failed\n")


@pytest.mark.usefixtures("swings", "impatient")
def test_a_list_of_normalized_clips_that_are_nowhere_is_not_written(processes, run):
    processes.start_worker("elsewhere")
    assert run("normalize", "in", "-s", "golf-normalize.yaml", "-o", "out", "--scheduler", processes.address).exit_code
    assert not Path("out/normalization.json").exists()


@pytest.mark.usefixtures("swings")
def test_ctrl_c_ends_the_run_and_what_it_asked_for(two, tmp_path):
    code = f"""
import os, sys
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.batch.pool import results_in_order
from motionedit.cli.boundary import run_guarded
wait = "open({str(tmp_path / "begun")!r}, 'a').close() or __import__('time').sleep(0.3)"
sys.exit(run_guarded(lambda: list(results_in_order(eval, [wait] * 500, options=RunOptions(scheduler={two!r})))))
"""
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),  # noqa: PLW1509  no threads here
    )
    while not (tmp_path / "begun").exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=20) == ("", "motionedit: error: interrupted\n")
    assert process.returncode == 130
    start = time.monotonic()
    assert list(results_in_order(eval, ["1"], options=RunOptions(scheduler=two))) == [1]
    assert time.monotonic() - start < 10.0, "the workers are still at what nobody wants"


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("nobody", ["tcp://127.0.0.1:1", "nonsense://x", "???", "tls://127.0.0.1:1"])
def test_an_address_without_a_scheduler_is_a_usage_error(nobody):
    with pytest.raises(UsageError, match="no Dask scheduler answers"):
        list(results_in_order(abs, [1], options=RunOptions(scheduler=nobody)))


@pytest.mark.usefixtures("impatient")
def test_a_server_of_another_kind_is_no_scheduler(capfd):
    with socket.create_server(("127.0.0.1", 0)) as silent:
        options = RunOptions(scheduler=f"tcp://127.0.0.1:{silent.getsockname()[1]}")
        with pytest.raises(UsageError, match="no Dask scheduler answers"):
            list(results_in_order(abs, [1], options=options))
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("swings")
def test_a_cluster_is_not_asked_where_nothing_is_to_be_done(run):
    run("edit-prioritized", "in", "-s", "hand.yaml", "-o", "out", "-q")
    done = run("edit-prioritized", "in", "-s", "hand.yaml", "-o", "out", "--update", "--scheduler", "tcp://nobody:1")
    assert (done.exit_code, done.stderr) == (0, "4 up to date\n")


@pytest.mark.parametrize(
    ("arguments", "said"), [(("-", "-o", "o.bvh", "--scheduler", "x:1"), "elsewhere"), (("--scheduler", ""), "empty")]
)
def test_a_cluster_is_of_files_and_has_a_name(run, copy_spec, arguments, said):
    done = run("edit-prioritized", "-s", copy_spec.name, *arguments, stdin=b"")
    assert (done.exit_code, said in done.stderr) == (2, True), done.stderr
