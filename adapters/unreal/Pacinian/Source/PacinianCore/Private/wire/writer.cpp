#include "pacinian/wire/writer.h"

#include <cstring>
#include <limits>

namespace pacinian::wire {

namespace {

template <class T>
constexpr std::uint64_t most = std::numeric_limits<T>::max();

/// Appends a byte, then `size` bytes of a number, the most significant first.
void append(Bytes& to, int first, std::uint64_t number, int size) {
  to.push_back(static_cast<std::uint8_t>(first));
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
    to.push_back(static_cast<std::uint8_t>(number >> shift));
}

/// Appends an unsigned number in as few bytes as possible. first: the byte before one byte; those before 2, 4 and 8
/// follow it.
void append_shortest(Bytes& to, int first, std::uint64_t number) {
  if (number <= most<std::uint8_t>)
    append(to, first, number, 1);
  else if (number <= most<std::uint16_t>)
    append(to, first + 1, number, 2);
  else if (number <= most<std::uint32_t>)
    append(to, first + 2, number, 4);
  else
    append(to, first + 3, number, 8);
}

/// Appends the head of a map or array. small: contains the count if it is less than 16.
void append_head(Bytes& to, int small, int medium, std::size_t count) {
  if (count < 16)
    append(to, small | static_cast<int>(count), 0, 0);
  else if (count <= most<std::uint16_t>)
    append(to, medium, count, 2);
  else
    append(to, medium + 1, count, 4);
}

}  // namespace

void Writer::nil() { bytes_.push_back(0xC0); }

void Writer::map(std::size_t count) { append_head(bytes_, 0x80, 0xDE, count); }

void Writer::array(std::size_t count) { append_head(bytes_, 0x90, 0xDC, count); }

void Writer::text(std::string_view value) {
  if (value.size() < 32)
    append(bytes_, 0xA0 | static_cast<int>(value.size()), 0, 0);
  else
    append_shortest(bytes_, 0xD9, value.size());
  bytes_.insert(bytes_.end(), value.begin(), value.end());
}

void Writer::bin(const std::uint8_t* data, std::size_t size) {
  append_shortest(bytes_, 0xC4, size);
  bytes_.insert(bytes_.end(), data, data + size);
}

void Writer::extension(std::int8_t type, const std::uint8_t* data, std::size_t size) {
  int fixed = 0xD4;  // for 1, 2, 4, 8 or 16 bytes
  for (std::size_t length = 1; length < size && length < 16; length *= 2) ++fixed;
  if (size == std::size_t{1} << (fixed - 0xD4))
    bytes_.push_back(static_cast<std::uint8_t>(fixed));
  else
    append_shortest(bytes_, 0xC7, size);
  bytes_.push_back(static_cast<std::uint8_t>(type));
  bytes_.insert(bytes_.end(), data, data + size);
}

void Writer::put(bool value) { bytes_.push_back(value ? 0xC3 : 0xC2); }

void Writer::put(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  append(bytes_, 0xCB, bits, 8);
}

void Writer::put(std::int64_t value) {
  const auto number = static_cast<std::uint64_t>(value);
  if (value >= 0)
    put(number);
  else if (value >= -32)
    bytes_.push_back(static_cast<std::uint8_t>(value));
  else if (value >= std::numeric_limits<std::int8_t>::min())
    append(bytes_, 0xD0, number, 1);
  else if (value >= std::numeric_limits<std::int16_t>::min())
    append(bytes_, 0xD1, number, 2);
  else if (value >= std::numeric_limits<std::int32_t>::min())
    append(bytes_, 0xD2, number, 4);
  else
    append(bytes_, 0xD3, number, 8);
}

void Writer::put(std::uint64_t value) {
  if (value < 128)
    bytes_.push_back(static_cast<std::uint8_t>(value));
  else
    append_shortest(bytes_, 0xCC, value);
}

void Writer::put(const Raw& value) {
  bytes_.insert(bytes_.end(), value.bytes.begin(), value.bytes.end());
}

}  // namespace pacinian::wire
