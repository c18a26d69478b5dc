"""The contestants' code for their own processes. Each file is loaded by path and imports none of the others."""
