"""Scenes of virtual objects and hands, and the samples that represent them to a solver."""
