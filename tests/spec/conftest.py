"""Specs written to a folder, and what loading them says."""

from textwrap import dedent

import pytest

from motionedit.errors import MotionEditError
from motionedit.spec.load import load_spec

HEADS = {
    "normalize": "schema: motionedit/normalize/v1\n",
    "fit-pca": "schema: motionedit/fit-pca/v1\n",
    "edit-pc": "schema: motionedit/edit-pc/v1\n",
    "edit-prioritized": "schema: motionedit/edit-prioritized/v1\n",
}


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Load a spec from text, as the file `spec.yaml` of the current folder."""
    monkeypatch.chdir(tmp_path)

    def loaded(text, command="edit-pc", *overrides, head=True):
        path = tmp_path / "spec.yaml"
        body = text if isinstance(text, bytes) else dedent(text).encode()
        path.write_bytes(HEADS[command].encode() + body if head else body)
        return load_spec(path.relative_to(tmp_path), command, overrides=overrides)

    return loaded


@pytest.fixture
def messages(load):
    """Return the lines that a faulty spec is answered with; line 1 is the schema's."""

    def lines(text, command="edit-pc", *overrides, head=True):
        with pytest.raises(MotionEditError) as caught:
            load(text, command, *overrides, head=head)
        assert caught.value.exit_code == 2
        found = [str(error) for error in caught.value.errors]
        assert all("\n" not in line for line in found)
        return found

    return lines
