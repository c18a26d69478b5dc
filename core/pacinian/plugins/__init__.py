"""The interfaces that plug-ins implement, and their discovery."""
