"""The built-in scenes: time per tick, saved work, audible noise."""
