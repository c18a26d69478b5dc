"""Sound in air: the medium, transducers, arrays, and propagation from an array to points."""
