"""The wire protocol: every message between a client and `pacinian serve`, its codec and its documentation.

protocol.py            version, limits (1 MiB a command), field types; a message is a MessagePack map
commands.py            messages to the command socket: put, move, remove, envelopes, hands, zones, field
control.py             messages to the control socket: hello, renew, arm, disarm, stop, select, status
replies.py             the server's answers: welcome, ok, error, renewed, plug-ins
state.py               what the server publishes: `State` and `FrameState`, every field
objects.py             haptic objects, materials, motion, textures in a message
shapes.py              shapes and curves in a message
modulation.py          envelopes and techniques in a message
codec.py               bytes to messages and back: encode, decode_command, check_part, id_of
binary_arrays.py       arrays of float32 or uint32 in a `bin`: pack, unpack, checks of range and length
decode_errors.py       WireError of an invalid message: path of the wrong field, problem, known types
convert.py             messages to scene objects and back
convert_shapes.py      shapes, poses, textures to those of a scene and back; degrees and radians
convert_modulation.py  envelopes and techniques to those of a scene and back
connection_file.py     the connection file: where it lies, secret, permissions; `PACINIAN_CONNECTION`
stop_datagram.py       an emergency stop by a datagram with HMAC, without a connection
silence_cause.py       the causes of silence, as codes; their sentences: serving/control/explain_silence.py
state_wording.py       numbers of a state in words, for people: counts, percent
felt_regions.py        decodes what is felt of each region: `State.felt`
message_docs.py        fields, types, bounds and meanings of messages, from their docstrings
protocol_pages.py      writes docs/wire.md and docs/wire-messages.md from guide.md, messages.md
asyncapi.py            the AsyncAPI document, JSON Schemas
"""
