"""Test numerical stability: hard problems, the promises of every solver, and whether the solver keeps them."""
