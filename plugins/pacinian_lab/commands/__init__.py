"""The laboratory's commands, one file a command."""
