"""Pacinian's own plug-ins: one file each, every one its own entry point, no privileges."""
