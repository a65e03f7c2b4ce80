"""What damaged files are given to: commands, in a folder that is forgotten after each, and what they may answer."""

import contextlib
import os
import sys
import tempfile
import time
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(ROOT / "tests" / "unit"), str(ROOT / "tests" / "unit" / "core")]

from motionedit.cli import main  # noqa: E402  beside the lines above, which find the test's own files

SECONDS = 20.0  # of the processor; what takes longer hangs
FOUND = ROOT / "out" / "fuzz"  # what broke something: a seed to be

# As often as `make fuzz` says, other files each time; else a few, always the same.
EXAMPLES = int(os.environ.get("MOTIONEDIT_FUZZ", "0"))
settings.register_profile(
    "fuzz",
    max_examples=EXAMPLES or 25,
    derandomize=not EXAMPLES,
    database=None,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture(scope="session")
def answer():
    """Return a function that runs a command on files (name: bytes) and returns its exit code and what it wrote."""

    def run(files, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            for name, data in files.items():
                path = Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
            started = time.process_time()
            with contextlib.chdir(folder):
                result = CliRunner().invoke(main, list(arguments))
            taken = time.process_time() - started
            wrote = {path.relative_to(folder).as_posix(): path.read_bytes() for path in Path(folder).rglob("*.*")}
        try:
            assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
            assert result.exit_code in {0, 1, 2, 3}, result.output
            assert "please report it" not in result.output, result.output
            assert "Traceback" not in result.output, result.output
            assert taken < SECONDS
        except AssertionError:
            for name, data in files.items():
                (FOUND / name).parent.mkdir(parents=True, exist_ok=True)
                (FOUND / name).write_bytes(data)
            raise
        return result, {name: data for name, data in wrote.items() if name not in files}

    return run
