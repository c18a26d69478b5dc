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

/// Returns the i-th uint32 of bulk numbers, which must exist.
inline std::uint32_t uint32_at(const Bytes& from, std::size_t i) {
  std::uint32_t bits = 0;
  for (std::size_t k = 4; k > 0; --k) bits = bits << 8 | from[4 * i + k - 1];
  return bits;
}

/// Returns the i-th float32 of bulk numbers, which must exist.
inline float float_at(const Bytes& from, std::size_t i) {
  const std::uint32_t bits = uint32_at(from, i);
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// Rules of fields, as in pacinian/wire/bulk.py. The functions return false if a rule is broken, and report field and
// reason to `in`.

/// Checks for rows of `width` float32. counts: the allowed numbers of rows; empty: any.
bool rows(Reader& in, const char* name, const Bytes& data, std::size_t width,
          std::initializer_list<std::size_t> counts);

/// Checks that all float32 are from `low` to `high`, without NaN.
bool within(Reader& in, const char* name, const Bytes& data, double low, double high);

/// Checks for rows of three uint32 that are indices of the (V, 3) float32 of `into`.
bool in_bounds(Reader& in, const char* name, const Bytes& data, const Bytes& into);

/// Checks that the number of float32 is that of `grid`.
template <std::size_t N>
bool fills(Reader& in, const char* name, const Bytes& data,
           const std::array<std::int64_t, N>& grid) {
  std::size_t count = 1;
  for (std::size_t i = 0; i + 1 < N; ++i) count *= static_cast<std::size_t>(grid[i]);
  return rows(in, name, data, static_cast<std::size_t>(grid[N - 1]), {count});
}

}  // namespace pacinian::wire
