"""The command `pacinian`, one file a subcommand."""
