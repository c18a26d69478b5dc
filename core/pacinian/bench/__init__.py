"""Run time against error: ours and the peers, on the same problems, by one evaluator."""
