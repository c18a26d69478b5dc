#include "head.h"

#include <cstring>

namespace pacinian::wire {

namespace {

constexpr Kind kinds[] = {  // of the first bytes 0xC0 to 0xDF
    Kind::nil,       Kind::none,      Kind::boolean,   Kind::boolean,    // c0
    Kind::bin,       Kind::bin,       Kind::bin,       Kind::extension,  // c4
    Kind::extension, Kind::extension, Kind::real,      Kind::real,       // c8
    Kind::integer,   Kind::integer,   Kind::integer,   Kind::integer,    // cc
    Kind::integer,   Kind::integer,   Kind::integer,   Kind::integer,    // d0
    Kind::extension, Kind::extension, Kind::extension, Kind::extension,  // d4
    Kind::extension, Kind::text,      Kind::text,      Kind::text,       // d8
    Kind::array,     Kind::array,     Kind::map,       Kind::map};       // dc

constexpr std::uint8_t widths[] = {  // [bytes] of the number after these
    0, 0, 0, 0, 1, 2, 4, 1, 2, 4, 4, 8, 1, 2, 4, 8, 1, 2, 4, 8, 0, 0, 0, 0, 0, 1, 2, 4, 2, 4, 2, 4};

double real_of(std::uint64_t bits, int width) {
  if (width == 8) {
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  const auto narrow = static_cast<std::uint32_t>(bits);
  float value = 0.0F;
  std::memcpy(&value, &narrow, sizeof value);
  return static_cast<double>(value);
}

/// Extends a two's complement number of `width` bytes to 64 bits.
std::uint64_t widened(std::uint64_t bits, int width) {
  const int unused = 64 - 8 * width;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(bits << unused) >> unused);
}

}  // namespace

Kind kind_of(std::uint8_t first) {
  if (first < 0x80 || first >= 0xE0) return Kind::integer;
  if (first < 0x90) return Kind::map;
  if (first < 0xA0) return Kind::array;
  return first < 0xC0 ? Kind::text : kinds[first - 0xC0];
}

bool Reader::Head::read(const std::uint8_t*& next, const std::uint8_t* end) {
  *this = {};
  if (next == end) return false;
  const std::uint8_t first = *next++;
  kind = kind_of(first);
  if (first < 0xC0 || first >= 0xE0) {
    bits = widened(first, 1);
    size = first < 0xA0 ? first & 0x0Fu : first & 0x1Fu;
  } else {
    const int width = widths[first - 0xC0];
    if (end - next < width) return false;
    for (int i = 0; i < width; ++i) bits = (bits << 8) | *next++;
    size = static_cast<std::uint32_t>(bits);
    boolean = first == 0xC3;
    huge = first == 0xCF && bits >> 63 != 0;
    if (kind == Kind::real) real = real_of(bits, width);
    if (kind == Kind::integer && first >= 0xD0) bits = widened(bits, width);
    if (first >= 0xD4 && first <= 0xD8) size = 1u << (first - 0xD4);
  }
  if (kind == Kind::extension) {
    if (next == end) return false;
    extension = static_cast<std::int8_t>(*next++);
  }
  return true;
}

bool Reader::Head::find_body(const std::uint8_t*& next, const std::uint8_t* end) {
  if (kind != Kind::text && kind != Kind::bin && kind != Kind::extension) return true;
  if (static_cast<std::size_t>(end - next) < size) return false;
  body = next;
  next += size;
  return true;
}

double Reader::Head::number() const {
  if (kind == Kind::real) return real;
  return huge ? static_cast<double>(bits) : static_cast<double>(integer());
}

std::uint64_t Reader::Head::children() const {
  if (kind == Kind::array) return size;
  return kind == Kind::map ? 2 * std::uint64_t{size} : 0;
}

}  // namespace pacinian::wire
