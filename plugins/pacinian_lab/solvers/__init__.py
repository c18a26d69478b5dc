"""Run time against error: our solvers and the peers, on the same problems, by one evaluator."""
