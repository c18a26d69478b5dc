#pragma once

#include <cstddef>
#include <cstdint>

#include "pacinian/api.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/replies.h"
#include "pacinian/wire/state.h"

namespace pacinian::wire {

// Bytes to messages. False, with the reason in `error`, if they are none; `out` is then valid, but means nothing.
// A message of the same kind that is in `out` already lends its memory.

/// A message of the server.
PACINIANCORE_API bool decode_reply(const std::uint8_t* data, std::size_t size, AnyReply& out,
                                   WireError& error);

/// What the server publishes, without its topic.
PACINIANCORE_API bool decode_state(const std::uint8_t* data, std::size_t size, AnyState& out,
                                   WireError& error);

}  // namespace pacinian::wire
