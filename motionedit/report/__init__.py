"""What a run shows and leaves: tables, JSON and JUnit reports, the preview page."""
