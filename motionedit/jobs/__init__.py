"""The jobs: one folder or file per command, spec and clips in, files and a report out; no command line."""
