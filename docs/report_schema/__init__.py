"""What the JSON Schema of reports is written from, by docs/generate.py; tests hold every report against it."""
