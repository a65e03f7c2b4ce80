"""The JSON Schema of the reports, key by key."""
