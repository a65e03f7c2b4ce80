"""The timeline of one behaviour: durations, events, time warps, resampling and alignment ([PC] section 5)."""
