"""Mid-air haptic rendering: a scene goes in, gains for an ultrasound transducer array come out.

`__init__.pyi`, beside this file, lists the public names. Each is imported when it is first used.

The packages: acoustics, solving, scene, rendering (the loop), serving (the server), wire and client (its protocol),
viewing (the live viewer), devices, plugins (their interfaces), batch, plot, notebook, testing, cli, native (kernels).

session.py            `Session`, `solve`: what is reused from one solve to the next
array_api.py          the field and batches of solves for PyTorch, CuPy, JAX
gallery.py            the built-in scenes of `pacinian bench scenes`
demo_scene.py         the scene of `pacinian demo`
skip_reasons.py       reasons for work that is left out, as reports name them
errors.py             every error that Pacinian raises
region_numbers.py     region numbers of points that belong to no region
argument_checks.py    checks of arguments
types.py              array types
config_files.py       reads TOML and JSON files; errors name the file and the key; JSON Schemas
config_key_advice.py  suggests the intended key for a wrong one in such a file
neighbours.py         nearest points; neighbours.hpp: its k-d tree
atomic_file.py        replaces a file as a whole, so that a full disk leaves the old one
exclusive_lock.py     exclusive locks on open files
closeable.py          the base of what a `with` statement closes
"""

from typing import Any

import lazy_loader

_find, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
MODULES = "plot", "testing"  # public modules that are imported by themselves


def __getattr__(name: str) -> Any:
    """Import a public name. Raises AttributeError, which suggests the names that are meant."""
    if name in __all__:
        return _find(name)
    raise AttributeError(f"module 'pacinian' has no attribute {name!r}{_suggest(name)}")


def _suggest(name: str) -> str:
    if name in MODULES:
        return f": write `from pacinian import {name}` first"
    if name.startswith("_"):  # tools look for many such names
        return ""
    import difflib

    known = {known.lower().replace("_", ""): known for known in reversed(__all__)}
    plain = name.lower().replace("_", "")
    close = difflib.get_close_matches(plain, known, 3, 0.7)
    return f": did you mean {' or '.join(repr(known[word]) for word in close)}?" if close else ""
