"""Mid-air haptic rendering: a scene goes in, gains for an ultrasound transducer array come out.

`__init__.pyi`, beside this file, lists the public names. Each is imported when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
