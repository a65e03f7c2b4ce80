"""The made-up bodies beside this file serve the tests in the folders below it, too: pytest looks for them here."""
