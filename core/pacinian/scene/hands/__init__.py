"""Hands, given by joints or by a mesh, and their skin."""
