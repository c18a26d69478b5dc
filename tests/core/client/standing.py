"""Old name of `stopped_processes`, until tests/adapters imports that."""

from .stopped_processes import STILL, server_apart, stand_still

__all__ = ["STILL", "server_apart", "stand_still"]
