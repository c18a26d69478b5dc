"""Hands: joints or a mesh, and the skin on them."""
