#pragma once

#include <cstddef>
#include <string_view>

#include "pacinian/client/events.h"
#include "pacinian/wire/commands.h"
#include "pacinian/wire/protocol.h"

namespace pacinian::client {

inline constexpr std::size_t largest = wire::MAX_COMMAND_BYTES - 1024;  ///< [bytes] of one object: the rest is for other fields

/// Returns whether a name has 1 to 64 characters, in UTF-8.
bool is_name(std::string_view name);

/// Returns whether the server would reject an object, and why: it rejects a whole message because of one wrong object.
/// Does not know the limits in the server's own settings.
bool refuse(std::string_view name, const wire::Object& object, Refusal& why);

}  // namespace pacinian::client
