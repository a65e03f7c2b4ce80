"""A headless Chromium for the tests of the preview page, and clips to show in it."""

import os
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
# The made-up player of the unit tests; and this folder, for whoever collects it alone.
sys.path[:0] = [str(HERE), str(HERE.parent / "unit")]

from devtools import Page, find_chromium  # noqa: E402  found by the line above
from mannequin import bvh_text  # noqa: E402  the same

from motionedit.jobs.preview import job as preview  # noqa: E402  after them


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    executable = find_chromium()
    if executable is None:
        pytest.skip("no chromium on this machine: the preview page is tested in one")
    profile = tmp_path_factory.mktemp("profile")
    page = Page(executable, str(profile))
    yield page
    page.close()


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pages")


@pytest.fixture(scope="session")
def page_of(folder):
    """Return a function from clips, each the options of the made-up player, to the address of their page."""

    def make(name, *clips):
        paths = [folder / f"{name}{i}.bvh" for i in range(len(clips))]
        for path, options in zip(paths, clips, strict=True):
            path.write_text(bvh_text(**options))
        target = folder / f"{name}.html"
        preview.run(paths, target)
        return target.as_uri()

    return make


@pytest.fixture(scope="session")
def single(page_of):
    return page_of("single", {"frames": 60})


@pytest.fixture(scope="session")
def pair(page_of):
    return page_of("pair", {"frames": 30}, {"frames": 59, "frame_time": 0.02, "swing": 80.0})


@pytest.fixture(scope="session")
def real_clips():
    folder = os.environ.get("MOTIONEDIT_CLIPS")
    if not folder or not Path(folder).is_dir():
        pytest.skip("MOTIONEDIT_CLIPS names no folder of real clips")
    return Path(folder)
