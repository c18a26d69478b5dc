"""Real devices: what they are made of, how they were measured, and whether all of it is there."""
