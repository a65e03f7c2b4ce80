"""The made-up bodies beside this file serve the tests in the folders below it, too: pytest looks for them here."""

import pytest


@pytest.fixture
def patch():
    """Return a monkeypatch that hypothesis may use for many examples."""
    with pytest.MonkeyPatch.context() as context:
        yield context
