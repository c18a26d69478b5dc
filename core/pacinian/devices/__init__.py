"""Real devices: descriptions, calibration and USB access.

description.py      `DeviceDescription`: its file: boards, levels; makes `Array` and wiring, without dead channels
board.py            one board: channel order, which channels are dead, gain, phase and their standard errors
layouts.py          positions of transducers on a board: grid, list of places, AUTD unit (as in acoustics/array.py)
calibration.py      calibration files (CSV): strength and phase of every channel; read, write, apply to boards
scan.py             microphone scan files: CSV, NPZ, HDF5; units of columns; several channels driven at once
scan_fit.py         `fit_scan`: P0, responses, speed of sound, pose; dead, reversed, odd transducers; what is vague
scan_check.py       which scans `fit_scan` refuses, and why
scan_robust_fit.py  the least squares of `fit_scan`: Gauss-Newton, Cauchy weights against outliers, covariance, priors
usb.py              `UsbKind`: finds, lists and selects USB devices by vendor, product, serial number
usb_link.py         `UsbLink`: claims a device; control requests, bulk OUT frames, within the time limits it is given
usb_errors.py       pyusb's errors in words, with advice: permission, driver, unplugged
device_users.py     which other programs have a device open, so that it is busy
"""
