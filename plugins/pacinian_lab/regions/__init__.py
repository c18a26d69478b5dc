"""How evenly regions press, measured at places that no solver was given."""
