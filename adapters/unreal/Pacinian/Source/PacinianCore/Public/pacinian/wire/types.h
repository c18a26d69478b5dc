#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pacinian::wire {

/// Bulk numbers: little-endian float32 or uint32, unless a field says otherwise.
using Bytes = std::vector<std::uint8_t>;

/// A map of names, in its order.
template <class T>
using Map = std::vector<std::pair<std::string, T>>;

/// An array, map, `bin` or extension that is kept as it came: MessagePack in its usual form.
struct Raw {
  Bytes bytes;
};

/// A setting.
using Scalar = std::variant<bool, std::int64_t, double, std::string>;

/// Anything that MessagePack has.
using Anything = std::variant<std::monostate, bool, std::int64_t, double, std::string, Raw>;

/// Why bytes are no message. path: of what is wrong, as `$.objects[...].shape.radius`.
struct WireError {
  std::string problem;
  std::string path;
};

}  // namespace pacinian::wire
