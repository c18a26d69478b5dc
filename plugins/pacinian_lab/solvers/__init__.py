"""Benchmark run time against error: Pacinian's solvers and the peers, on the same problems, with the same evaluator."""
