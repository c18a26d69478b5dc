"""Benchmark run time against error: Pacinian's solvers and the peers', on the same problems, by the same evaluator.

A contestant is any solver that is measured. A peer is another project, with its solvers. A worker is the process of one
project's solvers. An entry is a contestant in one mode, such as "cold" or "warm".

run.py             every entry solves one problem before the next
problems.py        random points before AUTD arrays, and how many of them by default; the evaluator's own B
targets.py         targets for Pacinian's solvers (ratios within a run), and how often they are met
score.py           error of the pressures that gains make, also with 8-bit levels
timing.py          time and memory of a call: quantiles, warm-up
worker.py          what runs in a worker: JSON lines on standard input and output
worker_process.py  starts a worker, asks it with a time limit, kills and restarts it; also a process with JSON lines
workers/           the solvers of each project, for its worker
peers.py           Python environments of the peers, built by .ci/peers
rows.py            measurements, as CSV and JSON
summary.py         medians of the fastest thread setting; growth of run time
report.py          all results as JSON
tables.py          results in a terminal
plots.py           pictures of run time against error and size
batches.py         batches of solves and large fields, on cores and GPUs
"""
