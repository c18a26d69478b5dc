"""Numerical stability: hard problems, what every solver promises of them, and whether it is kept."""
