"""The made-up body beside this file serves the tests in the folders below it: pytest looks for it here."""
