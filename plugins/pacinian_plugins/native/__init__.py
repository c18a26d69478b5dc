"""The plug-ins' kernels, compiled from C++: see `pacinian.native`."""

from pacinian import native

native.publish(__name__)
