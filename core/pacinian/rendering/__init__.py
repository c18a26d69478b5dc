"""The loop: sample, propagate, solve, modulate, quantise, send."""
