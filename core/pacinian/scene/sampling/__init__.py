"""Sampling: turn a scene into samples, given what the hands touch, the array resolves and people feel."""
