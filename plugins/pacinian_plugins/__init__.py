"""Pacinian's own plug-ins. Each has its own entry point and uses only the public plug-in interface.

solvers/   `auto`, `single-focus`, `lagrange`, `pseudo-inverse`, `gs-pat`, `gs`, `weighted-gs`, `greedy`, `lbfgs`
backends/  `simulated`, `autd3`, `usb-autd`, `openmpd`, `sonicsurface`
native/    compiled C++ kernels of the solvers
"""
