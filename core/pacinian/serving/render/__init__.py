"""The render process: the loop, its copy of the owner's scene, and solver plug-ins."""
