"""The render loop: sample, propagate, solve, modulate, quantise, send."""
