"""The render process: the loop, its copy of the owner's scene, and solver plug-ins.

process.py, warmup.py          begins here; loads what the first ticks need
render_loop.py                 a tick: changes, orders, frame, report
scene_replica.py, change_decoding.py, background_loader.py   the copy of the scene; slow objects
solver_switcher.py, quiet_zones.py   another solver while the loop runs; zones, prepared beside it
frame_output.py                frames to the guard
renderer_status.py, touch_report.py   what is reported; what a hand touches, and if nothing, why
"""
