"""What a solver is given and what it gives: targets, limits, budget, propagator, solution."""
