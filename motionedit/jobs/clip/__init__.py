"""What the jobs share about one clip: its facts, what a spec names in it, its metrics."""
