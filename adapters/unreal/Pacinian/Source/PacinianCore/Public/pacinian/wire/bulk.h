#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <initializer_list>

#include "pacinian/wire/types.h"

namespace pacinian::wire {

class Reader;

/// Appends a number as little-endian float32.
inline void append(Bytes& to, float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  for (int shift = 0; shift < 32; shift += 8)
    to.push_back(static_cast<std::uint8_t>(bits >> shift));
}

/// The i-th uint32 of bulk numbers; there must be one.
inline std::uint32_t uint32_at(const Bytes& from, std::size_t i) {
  std::uint32_t bits = 0;
  for (std::size_t k = 4; k > 0; --k) bits = bits << 8 | from[4 * i + k - 1];
  return bits;
}

/// The i-th float32 of bulk numbers; there must be one.
inline float float_at(const Bytes& from, std::size_t i) {
  const std::uint32_t bits = uint32_at(from, i);
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// What fields must be, as in pacinian/wire/bulk.py; false, with the field and the reason in `in`, where they are not.

/// Rows of `width` float32; as many as one of `counts`, if any are given.
bool rows(Reader& in, const char* name, const Bytes& data, std::size_t width,
          std::initializer_list<std::size_t> counts);

/// All float32 from `low` to `high`, without NaN.
bool within(Reader& in, const char* name, const Bytes& data, double low, double high);

/// Rows of three uint32 that count the (V, 3) float32 of `into`.
bool in_bounds(Reader& in, const char* name, const Bytes& data, const Bytes& into);

/// As many float32 as `grid` says.
template <std::size_t N>
bool fills(Reader& in, const char* name, const Bytes& data,
           const std::array<std::int64_t, N>& grid) {
  std::size_t count = 1;
  for (std::size_t i = 0; i + 1 < N; ++i) count *= static_cast<std::size_t>(grid[i]);
  return rows(in, name, data, static_cast<std::size_t>(grid[N - 1]), {count});
}

}  // namespace pacinian::wire
