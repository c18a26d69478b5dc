"""Solvers, one algorithm each."""
