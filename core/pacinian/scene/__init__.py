"""Scenes: what is to be felt, where; and the samples that stand for it."""
