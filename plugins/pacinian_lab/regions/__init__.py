"""Benchmark how even the pressure of regions is, at places that no solver was given."""
