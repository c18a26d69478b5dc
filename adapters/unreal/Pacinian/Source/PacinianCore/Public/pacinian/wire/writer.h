#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

#include "pacinian/api.h"
#include "pacinian/wire/types.h"

namespace pacinian::wire {

/// Writes MessagePack, in the shortest forms and with 64-bit floats, into a buffer that is reused.
class Writer {
 public:
  /// Removes all bytes; keeps the memory.
  void clear() { bytes_.clear(); }
  const std::uint8_t* data() const { return bytes_.data(); }
  std::size_t size() const { return bytes_.size(); }
  const Bytes& bytes() const { return bytes_; }

  PACINIANCORE_API void nil();
  PACINIANCORE_API void map(std::size_t count);
  PACINIANCORE_API void array(std::size_t count);
  PACINIANCORE_API void text(std::string_view value);
  PACINIANCORE_API void bin(const std::uint8_t* data, std::size_t size);
  PACINIANCORE_API void extension(std::int8_t type, const std::uint8_t* data, std::size_t size);

  PACINIANCORE_API void put(bool value);
  PACINIANCORE_API void put(double value);
  PACINIANCORE_API void put(std::int64_t value);
  PACINIANCORE_API void put(std::uint64_t value);
  void put(const std::string& value) { text(value); }
  void put(const Bytes& value) { bin(value.data(), value.size()); }
  PACINIANCORE_API void put(const Raw& value);
  void put(std::monostate) { nil(); }

  template <class T, std::size_t N>
  void put(const std::array<T, N>& items) {
    array(N);
    for (const T& item : items) put(item);
  }

  template <class T>
  void put(const std::vector<T>& items) {
    array(items.size());
    for (const T& item : items) put(item);
  }

  template <class T>
  void put(const Map<T>& entries) {
    map(entries.size());
    for (const auto& entry : entries) field(entry.first, entry.second);
  }

  template <class T>
  void put(const std::optional<T>& value) {
    if (value)
      put(*value);
    else
      nil();
  }

  template <class... T>
  void put(const std::variant<T...>& value) {
    (put_if(std::get_if<T>(&value)), ...);
  }

  /// Writes a message, or a word.
  template <class T>
  void put(const T& value) {
    if constexpr (std::is_enum_v<T>)
      text(words(value)[static_cast<std::size_t>(value)]);
    else
      write(*this, value);
  }

  template <class T>
  void field(std::string_view name, const T& value) {
    text(name);
    put(value);
  }

 private:
  template <class T>
  void put_if(const T* value) {
    if (value) put(*value);
  }

  Bytes bytes_;
};

}  // namespace pacinian::wire
