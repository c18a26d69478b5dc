"""The solvers of each project, for its worker. Each file is loaded by path and imports none of the others.

pacinian.py    Pacinian's solvers; the references: roofline, a fixed GEMM
autd3.py       autd3-pattern-holo: GS-PAT, Gerchberg-Saxton, naive, greedy
acoustools.py  AcousTools: weighted Gerchberg-Saxton, GS-PAT; PyTorch
levitate.py    levitate: L-BFGS-B
"""
