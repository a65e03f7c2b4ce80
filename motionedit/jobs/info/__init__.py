"""What is in a clip, as a record and as text."""
