"""Solvers: one module or package per algorithm.

auto.py            `auto`: chooses the solver by points, regions, limits and error
single_focus.py    `single-focus`: one point, in closed form
lagrange/          `lagrange`: least squares under all limits; regions; free or given phases
pseudo_inverse.py  `pseudo-inverse`: equation (9), the least-squares solution of least norm
gs_pat.py          `gs-pat`: Gerchberg-Saxton on the Gram matrix
gs/                `gs` and `weighted-gs`: Gerchberg-Saxton between points and transducers
greedy.py          `greedy`: a phase for one transducer after the other
greedy.hpp         this search: called by greedy.py
lbfgs.py           `lbfgs`: all phases and amplitudes at once, by SciPy's L-BFGS
"""
