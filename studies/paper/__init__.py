"""The tables and figures of the two papers, measured and drawn anew with this tool's own jobs."""
