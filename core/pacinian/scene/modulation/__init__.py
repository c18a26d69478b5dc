"""Envelopes, which set an object's amplitude over time, and techniques, which present its samples in time."""
