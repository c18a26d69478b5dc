"""What drives a device loads no more than it needs: neither compiled kernels nor what boards of others need."""

from __future__ import annotations

import subprocess
import sys

CODE = """
import sys, numpy as np, pacinian as pc
from pacinian_plugins.backends.openmpd import OpenMpd
from pacinian_plugins.backends.sonicsurface import SonicSurface
from pacinian_plugins.backends.usb_autd import UsbAutd
OpenMpd(), SonicSurface(), list(OpenMpd.find_devices()), list(SonicSurface.find_devices())
b = UsbAutd(pretend=True); b.open(pc.autd(3, 3)); z = np.zeros((2, 2241), np.uint16)
b.send(pc.Frame(0, 0.0, z, z)); b.close()
loaded = {"pacinian.native", "scipy", "pyftdi"} & set(sys.modules)
assert not loaded, loaded
"""


def test_no_backend_of_boards_loads_kernels_scipy_or_pyftdi() -> None:
    subprocess.run([sys.executable, "-c", CODE], check=True)
