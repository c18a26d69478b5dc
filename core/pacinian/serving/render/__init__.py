"""The render process: the loop, its copy of the active scene, solver plug-ins."""
