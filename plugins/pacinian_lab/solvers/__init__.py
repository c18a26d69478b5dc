"""Benchmark run time against error: Pacinian's solvers and the peers, on the same problems, with the same evaluator.

problems.py, targets.py        the problems; targets for the solvers, and in how many problems they are met
run.py, timing.py, score.py    one problem after the other, each by all; time and memory of a call; error
worker.py, worker_process.py, peers.py   a contestant in a process of its own; environments of peers
rows.py, summary.py, report.py, tables.py, plots.py   measurements; their medians; as JSON, tables, pictures
batches.py                     batches of solves and large fields
"""
