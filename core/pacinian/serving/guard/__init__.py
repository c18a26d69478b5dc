"""The guard process: the only one that opens the device. It lets frames through while they are permitted and fresh.

process.py          begins here: the rounds, and the last resort if one hangs
output_gate.py      each round's decision: send the frame, or silence the device, for example because the newest frame
                    is older than `frame_timeout` (serving/settings.py)
device_manager.py   opens, resets and closes devices, while another may sound. A lost device is a fault until a reset
spare_guard.py      the guard that waits to replace one that ended or hangs
"""
