#pragma once

#include <cstddef>
#include <cstdint>

#include "pacinian/wire/reader.h"

namespace pacinian::wire {

/// The head of a MessagePack value, and its body if that is not further values.
struct Reader::Head {
  Kind kind = Kind::none;
  bool boolean = false;
  bool huge = false;           ///< an integer above 63 bits, which is in `bits`
  std::int8_t extension = 0;   ///< type of an extension
  std::uint32_t size = 0;      ///< items, pairs, or bytes of the body
  std::uint64_t bits = 0;      ///< an integer in two's complement
  double real = 0.0;
  const std::uint8_t* body = nullptr;

  /// Reads a head from the bytes before `end`, and advances `next`. Returns false if the bytes are truncated.
  bool read(const std::uint8_t*& next, const std::uint8_t* end);

  /// Finds the body, if there is one, and advances `next`. Returns false if the bytes are truncated.
  bool find_body(const std::uint8_t*& next, const std::uint8_t* end);

  std::int64_t integer() const { return static_cast<std::int64_t>(bits); }
  double number() const;  ///< floating-point or integer
  std::uint64_t children() const;  ///< number of values that follow and belong to it
};

/// Returns the kind of value that a first byte starts; none for the byte that is never used.
Kind kind_of(std::uint8_t first);

}  // namespace pacinian::wire
