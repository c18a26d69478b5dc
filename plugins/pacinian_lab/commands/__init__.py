"""The commands of the laboratory: one file for each command.

bench.py            `pacinian bench`: run time and error of solvers (solvers/); how many points and seeds
bench_batches.py    `pacinian bench batches`: many solves on cores and GPUs
bench_regions.py    `pacinian bench regions`: evenness of surfaces and volumes
bench_scenes.py     `pacinian bench scenes`: built-in scenes at 1 kHz
bench_tick.py       `pacinian bench tick`: time of a tick in kernels, Python, wake-up
bench_bus.py        `pacinian bench bus`: latency and load of a server
bench_expiry.py     `pacinian bench expiry`: from the end of a permit to silence
bench_faults.py     `pacinian bench faults` and `pacinian bench hostile`: break and flood a server
bench_footprint.py  `pacinian bench footprint`: start, memory, processor time of a server
bench_view.py       `pacinian bench view`: cost of the live viewer
bench_devices.py    `pacinian bench devices`: frame timing at device models
bench_examples.py   `pacinian bench examples`: other projects' haptic examples
paper.py            `pacinian paper`: the paper's experiment, figures, forces
soak.py             `pacinian soak`: a server that runs for long
stress.py           `pacinian stress`: guarantees of solvers on hard problems
study.py            `pacinian study`: layouts, planes, patterns, solvers in all combinations
shared.py           what they share: the option --units, tables, the check for matplotlib, the folder of results
"""
