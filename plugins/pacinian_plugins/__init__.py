"""Pacinian's own plug-ins. Each has its own entry point and uses only the public plug-in interface."""
