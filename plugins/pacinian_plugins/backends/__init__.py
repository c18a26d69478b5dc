"""Backends, one device each."""
