"""Inputs and outputs of solvers: targets, limits, budget, propagator and solution."""
