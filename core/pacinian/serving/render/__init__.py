"""The render process: the loop, its copy of the owner's scene, and solver plug-ins.

process.py             begins here
render_loop.py         a tick: changes, selections, frame, report; fewer ticks at rest; fades before a lease ends
scene_replica.py       the copy of the scene: changes, the intensity and the default technique are applied to it
change_decoding.py     changes from the bus as scene values
background_loader.py   meshes and sounds that take long to prepare
zone_placement.py      where quiet zones are, prepared beside the loop
solver_switcher.py     another solver while the loop runs
frame_output.py        frames to the guard
renderer_status.py     what is reported of the loop
touch_report.py        what a hand touches, and if nothing, why
warmup.py              loads what the first ticks need
"""
