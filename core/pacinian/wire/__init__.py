"""The wire: every message between a client and `pacinian serve`, its codec, its document.

protocol.py   version, limits, field types       objects.py, shapes.py, time.py   what is to be felt
commands.py   client to command socket           control.py                       client to control socket
replies.py    server to client                   state.py                         what the server publishes
codec.py      bytes to messages and back         convert.py, convert_*.py         wire objects to scene objects and back
bulk.py       numbers in a `bin`                 within.py                        where an argument is wrong
page.py       docs/wire.md, with page.md         document.py                      AsyncAPI; both by described.py
vectors.py    tests/wire                         examples*.py, malformed.py       what is in them
connection.py where the server is                 emergency.py                      a stop without a connection
"""
