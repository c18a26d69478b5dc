"""Test vectors of the wire: messages as bytes and as values, for clients in every language.

vectors.py         writes tests/wire/*.json: messages as bytes and as values
examples.py        messages of a client, with all that they can contain
reply_examples.py  messages of the server
malformed.py       bytes that must be refused, and unusual ones that must be accepted
"""
