"""The golf swings normalized, fitted and edited twice: by the command line, and by the face in Python."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import motionedit
from motionedit.cli import main
from motionedit.spec.yaml_tree import value_from_text

ROOT = Path(__file__).resolve().parents[2]


class CommandLine:
    """Runs commands in a folder and keeps what they print."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self, *arguments, report=None):
        report = self.folder / f"{report}.json" if report else None
        more = ["--report", str(report)] if report else []
        done = CliRunner().invoke(main, [*map(str, arguments), *more])
        assert done.exit_code == 0, done.stderr
        lines = done.stderr.splitlines()
        self.warnings = [line.partition("warning: ")[2] for line in lines if line.startswith("motionedit: warning")]
        return json.loads(report.read_text()) if report else None


@pytest.fixture(autouse=True)
def at_root(monkeypatch):
    monkeypatch.chdir(ROOT)


@pytest.fixture
def command_line(tmp_path):
    return CommandLine(tmp_path)


@pytest.fixture(scope="session")
def normalized():
    return motionedit.normalize(ROOT / "data" / "golf", ROOT / "configs" / "golf-normalize.yaml")


@pytest.fixture(scope="session")
def fitted(normalized):
    return motionedit.fit_pca(normalized, ROOT / "configs" / "golf-fit.yaml")


@pytest.fixture
def mapping():
    """Return a reader of a spec of configs/ as a mapping."""
    return lambda name: value_from_text((ROOT / "configs" / f"{name}.yaml").read_text())
