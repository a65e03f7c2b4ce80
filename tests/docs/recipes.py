"""The files that pages ask a reader to save."""

import re


def block(text, language, name):
    head = rf"(?:#![^\n]*\n)?# file: {re.escape(name)}\n"
    found = re.search(rf"^```{language}\n({head}.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert found is not None, name
    return found.group(1)
