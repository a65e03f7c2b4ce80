"""--scheduler: the same run on a Dask cluster."""

from pathlib import Path

import pytest

from motionedit.errors import UsageError
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.batch.pool import results_in_order

distributed = pytest.importorskip("distributed", reason="needs the extra motionedit[cluster]")

# Dask's own event loops and sockets close late; none of that is ours to judge.
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def address():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        yield cluster.scheduler_address


def test_results_are_in_order(address):
    assert list(results_in_order(abs, range(-20, 0), options=RunOptions(scheduler=address))) == [*range(20, 0, -1)]


def test_the_workers_own_folder_does_not_matter(run, clip, copy_spec, address):
    names = ["in/a.bvh", "in/deep/b.bvh"]
    for seed, name in enumerate(names):
        clip(name, seed=seed)
    result = run("edit-prioritized", "in", "-s", copy_spec.name, "-o", "out", "--scheduler", address)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.split() == ["out/a.bvh", "out/deep/b.bvh"]
    for name in names:
        assert Path(name.replace("in/", "out/", 1)).read_bytes() == Path(name).read_bytes()


def test_an_address_without_a_scheduler_is_a_usage_error(monkeypatch):
    monkeypatch.setattr("motionedit.jobs.batch.pool._SECONDS_TO_CONNECT", 0.5)
    for nobody in ("tcp://127.0.0.1:1", "nonsense://x", "???"):
        with pytest.raises(UsageError, match="no Dask scheduler answers"):
            list(results_in_order(abs, [1], options=RunOptions(scheduler=nobody)))
