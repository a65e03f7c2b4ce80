"""What the workflow names is there, and the smoke test that it runs tells a good install from a bad one."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

from motionedit.core.compiled import solver_name

ROOT = Path(__file__).resolve().parents[2]
WORKFLOW = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
JOBS = WORKFLOW["jobs"]
COMMANDS = "\n".join(step["run"] for job in JOBS.values() for step in job["steps"] if "run" in step)


def test_scripts_and_folders_of_tests_that_it_names_exist():
    named = re.findall(r"(?<![\w/])(?:\.ci|tests)/[\w/.]+", COMMANDS + PROJECT["tool"]["cibuildwheel"]["test-command"])
    assert named
    for name in named:
        assert (ROOT / name).exists(), name


def test_targets_of_make_that_it_names_exist():
    targets = set(re.findall(r"^([a-z-]+):.*## ", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    named = set(re.findall(r"^make ([a-z-]+)", COMMANDS, re.MULTILINE))
    assert {"demo", "test", "test-lowest", "docs-check", "sanitize", "fuzz"} <= named <= targets


def test_a_job_waits_for_jobs_that_exist_and_a_release_for_all_of_them():
    needs = {name: job.get("needs", []) for name, job in JOBS.items()}
    needs = {name: [names] if isinstance(names, str) else names for name, names in needs.items()}
    assert {one for names in needs.values() for one in names} <= set(JOBS)
    waited_for, found = ["publish"], set()
    while waited_for:
        name = waited_for.pop()
        found.add(name)
        waited_for += needs[name]
    assert found == set(JOBS)


def test_only_the_last_job_may_speak_for_the_project():
    assert WORKFLOW["permissions"] == {"contents": "read"}
    assert [name for name, job in JOBS.items() if "permissions" in job] == ["publish"]
    assert not any("run" in step for step in JOBS["publish"]["steps"])


def test_every_python_that_is_promised_is_tried_and_wheels_are_built_with_the_oldest():
    tried = JOBS["test"]["strategy"]["matrix"]["python"]
    oldest = PROJECT["project"]["requires-python"].removeprefix(">=")
    tag = f"cp{oldest.replace('.', '')}"
    assert tried[0] == oldest
    wheels = PROJECT["tool"]["cibuildwheel"]
    assert wheels["build"] == [f"{tag}-*", f"cp{tried[-1].replace('.', '')}-*"]
    assert wheels["config-settings"] == {"--build-option": f"--py-limited-api={tag}"}
    assert set(JOBS["other-systems"]["strategy"]["matrix"]["python"]) == {oldest, tried[-1]}


def test_the_stable_abi_of_the_compiled_part_is_that_of_the_oldest_python():
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "motionedit").rglob("*.[ch]"))
    major, minor = map(int, PROJECT["project"]["requires-python"].removeprefix(">=").split("."))
    assert re.findall(r"#define Py_LIMITED_API (\w+)", sources) == [f"0x{major:02X}{minor:02X}0000"]


@pytest.mark.parametrize("solver", ["compiled", "numpy"])
def test_the_smoke_test_passes_with_the_solver_that_is_here_and_with_no_other(solver):
    command = [sys.executable, ROOT / ".ci" / "smoke.py", solver]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode == 0) == (solver == solver_name()), done.stdout
    assert (f"not the {solver} solver" in done.stdout) == (solver != solver_name())
