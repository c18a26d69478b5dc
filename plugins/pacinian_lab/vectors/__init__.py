"""Test vectors of the wire: messages as bytes and as values, for clients in every language."""
