"""The laboratory: benchmarks, fault injection, fuzzing, soak runs, studies, stress tests and the paper.

Studies are of arrays; there are no experiments with people. Nothing here is needed to render.
A plug-in adds its commands to `pacinian`.

plugin.py  the plug-in: adds the commands below to `pacinian`
commands/  one file for each command: `pacinian bench ...`, `soak`, `stress`, `study`, `paper`
solvers/   run time and error of Pacinian's solvers and of other projects'
regions/   how even the pressure of regions is between their samples
scenes/    time per tick of the built-in scenes, saved work, audible noise
server/    latency, load, soak of real servers; faults/ fault injection; fuzz/ malformed messages
devices/   frame timing, quantisation, scatter of transducers
examples/  examples of other projects, made again with Pacinian
stress/    numerical stability: hard problems, guarantees of solvers
study/     arrangements of arrays, compared
paper/     the paper's experiment, figures, forces
vectors/   test vectors of the wire
"""
