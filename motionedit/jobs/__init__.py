"""The jobs: one file per command, spec and clips in, files and a report out; no command line."""
