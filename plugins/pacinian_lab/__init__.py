"""The laboratory: benchmarks, fault injection, fuzzing, soak runs, studies, stress tests and the paper.

Nothing here renders. A plug-in adds its commands to `pacinian` (`pacinian_lab.plugin`).
"""
