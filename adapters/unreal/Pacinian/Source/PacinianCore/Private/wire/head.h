#pragma once

#include <cstddef>
#include <cstdint>

#include "pacinian/wire/reader.h"

namespace pacinian::wire {

/// What a MessagePack value starts with, and its body where it has one that is no further value.
struct Reader::Head {
  Kind kind = Kind::none;
  bool boolean = false;
  bool huge = false;           ///< a whole number above 63 bits: `bits` has it
  std::int8_t extension = 0;   ///< type of an extension
  std::uint32_t size = 0;      ///< items, pairs, or bytes of the body
  std::uint64_t bits = 0;      ///< a whole number, two's complement
  double real = 0.0;
  const std::uint8_t* body = nullptr;

  /// Reads it from the bytes up to `end`, and sets `next` behind it. False if it is cut short.
  bool read(const std::uint8_t*& next, const std::uint8_t* end);

  /// Finds the body, if there is to be one, and sets `next` behind it. False if it is cut short.
  bool find_body(const std::uint8_t*& next, const std::uint8_t* end);

  std::int64_t integer() const { return static_cast<std::int64_t>(bits); }
  double number() const;  ///< real or whole
  std::uint64_t children() const;  ///< values that follow and belong to it
};

/// The kind of value that a first byte starts; none for the byte that is never used.
Kind kind_of(std::uint8_t first);

}  // namespace pacinian::wire
