"""The commands of the laboratory: one file for each command."""
