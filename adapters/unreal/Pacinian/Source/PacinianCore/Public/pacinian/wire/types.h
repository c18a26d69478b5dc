#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pacinian::wire {

/// Bulk numbers: little-endian float32 or uint32, unless a field says otherwise.
using Bytes = std::vector<std::uint8_t>;

/// A map with names as keys, in order.
template <class T>
using Map = std::vector<std::pair<std::string, T>>;

/// An array, map, `bin` or extension as encoded MessagePack, in its shortest form.
struct Raw {
  Bytes bytes;
};

/// The value of a setting.
using Scalar = std::variant<bool, std::int64_t, double, std::string>;

/// Any value of MessagePack.
using Anything = std::variant<std::monostate, bool, std::int64_t, double, std::string, Raw>;

/// Why bytes are not a message. path: of the wrong field, such as `$.objects[...].shape.radius`.
struct WireError {
  std::string problem;
  std::string path;
};

}  // namespace pacinian::wire
