"""Backends, one device each.

simulated.py   `simulated`: stores frames, computes their field, fails on request
autd3/         `autd3`: AUTD3 units, through the AUTD3 project's packages
usb_autd/      `usb-autd`: AUTD units on USB, by Pacinian's own format
openmpd/       `openmpd`: OpenMPD boards behind an FT232H
sonicsurface/  `sonicsurface`: SonicSurface on a serial port
"""
