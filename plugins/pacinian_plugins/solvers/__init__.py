"""Solvers: one module or package per algorithm."""
