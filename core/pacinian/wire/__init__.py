"""The wire protocol: every message between a client and `pacinian serve`, its codec and its documentation.

protocol.py       version, limits, field types    objects.py, shapes.py, modulation.py   objects of a scene
commands.py       client to command socket        control.py                       client to control socket
replies.py        server to client                state.py                         messages that the server publishes
codec.py          bytes to messages and back      convert.py, convert_*.py         wire to scene objects and back
binary_arrays.py  numbers in a `bin`              error_path.py                    path of the field that is wrong
markdown.py       docs/wire*.md, with *.md        asyncapi.py                      the AsyncAPI document
message_docs.py   field tables from docstrings    connection_file.py               the connection file
emergency.py      a stop without a connection     silence_cause.py                 causes of silence
wording.py        words for figures of a state
"""
