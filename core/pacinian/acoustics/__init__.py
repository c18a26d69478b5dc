"""Sound in air: the medium, transducers, arrays, and the propagation between array and points."""
