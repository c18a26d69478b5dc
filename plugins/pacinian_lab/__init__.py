"""The laboratory: benchmarks, fault injection, fuzzing, soak runs, studies, stress tests and the paper.

Nothing here renders. A plug-in adds its commands to `pacinian`.

plugin.py, commands/           the plug-in; one file for each command
solvers/, regions/, scenes/    benchmarks of solvers against peers; of regions between samples; of ticks
server/                        of real servers: latency, load, faults (faults/), fuzzing (fuzz/), soak
devices/, stress/, study/      pacing and quantisation; numerical stability; arrangements of arrays
examples/, paper/, vectors/    examples of peers; the paper; test vectors of the wire
"""
