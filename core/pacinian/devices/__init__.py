"""Real devices: descriptions, calibration and USB access.

description.py, board.py, layouts.py   description files: boards, their poses, wiring and deviations
calibration.py                 strengths and phases of all channels, as files
scan.py, scan_fit.py, scan_least_squares.py   microphone scans, and what they say about a device
usb.py, usb_link.py, usb_errors.py   finds and selects USB devices; claims one; advice for each error
device_users.py                programs that have a device open
"""
