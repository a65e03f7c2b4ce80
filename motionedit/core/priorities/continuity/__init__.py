"""Passes that keep an edit continuous in time: smoothing, giving way, easing in and out of other constraints."""
