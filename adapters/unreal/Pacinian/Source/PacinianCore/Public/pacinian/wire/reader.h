#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "pacinian/api.h"
#include "pacinian/wire/bounds.h"
#include "pacinian/wire/types.h"

namespace pacinian::wire {

enum class Kind : std::uint8_t {
  none, nil, boolean, integer, real, text, bin, array, map, extension
};

/// Reads MessagePack from any bytes. Each method returns false if something else comes next. Integers are signed and
/// have 64 bits.
class Reader {
 public:
  static constexpr std::size_t most_entries = 1024;  ///< of a map without a limit of its own

  Reader(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}

  PACINIANCORE_API Kind next() const;  ///< the kind of the next value; none at the end
  PACINIANCORE_API bool done();        ///< whether all bytes have been read

  PACINIANCORE_API bool nil();  ///< consumes a nil if it comes next
  PACINIANCORE_API bool get(bool& out);
  PACINIANCORE_API bool get(double& out, Range range = {});
  PACINIANCORE_API bool get(std::int64_t& out,
                            std::int64_t low = std::numeric_limits<std::int64_t>::min(),
                            std::int64_t high = std::numeric_limits<std::int64_t>::max());
  PACINIANCORE_API bool get(std::string& out, Lengths characters = {});
  PACINIANCORE_API bool get(Bytes& out, Lengths lengths = {});
  PACINIANCORE_API bool get(Anything& out);
  PACINIANCORE_API bool word(std::string_view& out);  ///< a text, without a copy
  PACINIANCORE_API bool array(std::uint32_t& count, Lengths lengths = {});
  PACINIANCORE_API bool map(std::uint32_t& count, Lengths lengths = {});
  PACINIANCORE_API bool key(std::string_view& out);  ///< the name of a message's field
  PACINIANCORE_API bool skip();                      ///< any value of any depth

  /// Opens a map that has a `type`, and gives it as `tag`. left: the number of keys to read: without `type` if it comes
  /// first, otherwise all.
  PACINIANCORE_API bool open(std::string_view& tag, std::uint32_t& left);
  PACINIANCORE_API bool same(std::string_view tag);

  // Report an error. All return false, so that their results can be returned.
  PACINIANCORE_API bool wrong(std::string problem);      ///< in the last value read
  PACINIANCORE_API bool broken(const char* problem);     ///< in the bytes as a whole
  PACINIANCORE_API bool missing(std::string_view name);  ///< a missing field
  PACINIANCORE_API bool at(std::string_view name);       ///< adds the field to the error's path
  PACINIANCORE_API bool at(std::uint32_t index);         ///< adds the item to the error's path
  PACINIANCORE_API bool at_entry();                      ///< adds an entry of a map to the error's path
  PACINIANCORE_API WireError error() const;

  template <class T, std::size_t N, class Get>
  bool tuple(std::array<T, N>& out, Get get_item) {
    std::uint32_t count = 0;
    if (!array(count, {N, N})) return false;
    for (std::uint32_t i = 0; i < N; ++i)
      if (!get_item(out[i])) return at(i);
    return true;
  }

  template <class T, class Get>
  bool items(std::vector<T>& out, Lengths lengths, Get get_item) {
    std::uint32_t count = 0;
    if (!array(count, lengths)) return false;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (i == out.size()) out.emplace_back();
      if (!get_item(out[i])) return at(i);
    }
    out.resize(count);
    return true;
  }

  /// Reads a map with names as keys; if a name is repeated, the last value counts.
  template <class T, class Get>
  bool entries(Map<T>& out, Lengths characters, Lengths lengths, Get get_item) {
    std::uint32_t count = 0;
    if (!map(count, lengths)) return false;
    if (count > most_entries) return wrong("has too many keys");
    std::size_t used = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (used == out.size()) out.emplace_back();
      auto& [name, value] = out[used];
      if (!get(name, characters)) return false;
      if (!get_item(value)) return at_entry();
      std::size_t same_name = 0;
      while (out[same_name].first != name) ++same_name;
      if (same_name == used)
        ++used;
      else
        std::swap(out[same_name].second, value);
    }
    out.resize(used);
    return true;
  }

  template <class T, class Get>
  bool maybe(std::optional<T>& out, Get get_value) {
    if (nil()) {
      out.reset();
      return true;
    }
    if (!out) out.emplace();
    return get_value(*out);
  }

  /// Reads a part of a message that has no `type`.
  template <class T>
  bool part(T& out) {
    std::uint32_t left = 0;
    return map(left) && read(*this, left, out);
  }

  /// Reads one of a few words.
  template <class T>
  bool choice(T& out) {
    std::string_view found;
    if (!word(found)) return false;
    std::size_t i = 0;
    for (const std::string_view name : words(T{})) {
      if (name == found) {
        out = static_cast<T>(i);
        return true;
      }
      ++i;
    }
    return wrong("is none of the words that there are");
  }

  /// Reads a message by its `type`, or a word if the variant has words.
  template <class... T>
  bool one_of(std::variant<T...>& out) {
    bool known = false, good = false;
    if (((std::is_enum_v<T> && next() == Kind::text) || ...)) {
      (choose<T>(out, good), ...);
      return good;
    }
    std::string_view tag;
    std::uint32_t left = 0;
    if (!open(tag, left)) return false;
    (read_if<T>(out, tag, left, known, good), ...);
    return known ? good : unknown_tag();
  }

 private:
  struct Head;
  bool take(Head& out);
  bool take(Head& out, Kind wanted);
  bool copy(Bytes& out);
  PACINIANCORE_API bool unknown_tag();

  template <class T, class V>
  static T& alternative(V& out) {
    if (T* held = std::get_if<T>(&out)) return *held;
    return out.template emplace<T>();
  }

  template <class T, class V>
  void choose([[maybe_unused]] V& out, [[maybe_unused]] bool& good) {
    if constexpr (std::is_enum_v<T>) good = choice(alternative<T>(out));
  }

  template <class T, class V>
  void read_if(V& out, std::string_view tag, std::uint32_t left, bool& known, bool& good) {
    if constexpr (!std::is_enum_v<T>) {
      if (known || tag != T::tag) return;
      known = true;
      good = read(*this, left, alternative<T>(out));
    }
  }

  const std::uint8_t* next_;
  const std::uint8_t* end_;
  bool whole_ = false;
  std::string problem_;
  std::string path_;
};

}  // namespace pacinian::wire
