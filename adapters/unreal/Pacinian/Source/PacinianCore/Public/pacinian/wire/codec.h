#pragma once

#include <cstddef>
#include <cstdint>

#include "pacinian/api.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/replies.h"
#include "pacinian/wire/state.h"

namespace pacinian::wire {

// Decode messages. On failure they return false and the reason in `error`; `out` is then valid, but meaningless. If
// `out` already holds a message of the same kind, its memory is reused.

/// Decodes a reply of the server.
PACINIANCORE_API bool decode_reply(const std::uint8_t* data, std::size_t size, AnyReply& out,
                                   WireError& error);

/// Decodes a published message, without its topic.
PACINIANCORE_API bool decode_state(const std::uint8_t* data, std::size_t size, AnyState& out,
                                   WireError& error);

}  // namespace pacinian::wire
