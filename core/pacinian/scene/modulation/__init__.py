"""How strong an object is over time, and how its samples are presented."""
