"""Benchmarks of the built-in scenes: time per tick, saved work, audible noise."""
