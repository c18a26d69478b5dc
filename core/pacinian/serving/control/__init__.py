"""The control process: connections, sessions, who may sound, settings, status; it watches the other processes."""
