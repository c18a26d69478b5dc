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

/// Returns whether the server would reject an object, and why. For most of these reasons, the server would reject the
/// whole message, with all other objects in it. Not checked: whether a curve has a length, a mesh is closed and so on;
/// such an object alone is left out. most: the highest radiation pressure that the server allows [Pa].
bool refuse(std::string_view name, const wire::Object& object, double most, Refusal& why);

}  // namespace pacinian::client
