"""Other tools on the same jobs, each in an interpreter of its own."""
