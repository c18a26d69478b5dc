#pragma once

#include <cstddef>
#include <string_view>

#include "pacinian/client/events.h"
#include "pacinian/wire/commands.h"
#include "pacinian/wire/protocol.h"

namespace pacinian::client {

inline constexpr std::size_t largest = wire::MAX_COMMAND_BYTES - 1024;  ///< [bytes] of one object: the rest is for other fields

/// Whether the server would refuse an object, and why: one bad object would take others of its message with it. Limits of the
/// server's own settings are not known here.
bool refuse(std::string_view name, const wire::Object& object, Refusal& why);

}  // namespace pacinian::client
