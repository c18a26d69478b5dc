#pragma once

#include <cstddef>
#include <cstdint>

#include "pacinian/api.h"
#include "pacinian/wire/commands.h"
#include "pacinian/wire/control.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/replies.h"
#include "pacinian/wire/state.h"
#include "pacinian/wire/writer.h"

namespace pacinian::wire {

// Bytes to messages. False, with the reason in `error`, if they are none; `out` is then valid, but means nothing.
// A message of the same kind that is in `out` already lends its memory.

/// A message of the command socket.
PACINIANCORE_API bool decode_command(const std::uint8_t* data, std::size_t size, AnyCommand& out,
                                     WireError& error);

/// A message of the control socket.
PACINIANCORE_API bool decode_control(const std::uint8_t* data, std::size_t size, AnyControl& out,
                                     WireError& error);

/// A message of the server.
PACINIANCORE_API bool decode_reply(const std::uint8_t* data, std::size_t size, AnyReply& out,
                                   WireError& error);

/// What the server publishes, without its topic.
PACINIANCORE_API bool decode_state(const std::uint8_t* data, std::size_t size, AnyState& out,
                                   WireError& error);

/// A message, or a variant of such, as all that is in `out`. False if it is longer than `longest`: not to be sent.
template <class T>
bool encode(const T& message, Writer& out, std::size_t longest) {
  out.clear();
  out.put(message);
  return out.size() <= longest;
}

}  // namespace pacinian::wire
