#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pacinian/api.h"

namespace pacinian::wire {

/// The strings and integers of a JSON object, such as a connection file. Other values are skipped.
class FlatJson {
 public:
  static constexpr std::size_t longest = 1 << 16;  ///< [bytes]
  static constexpr int deepest = 16;               ///< nesting of skipped values

  /// Parses all of `text`. Returns false and the reason in `problem` if it is not a JSON object.
  PACINIANCORE_API bool parse(std::string_view text, std::string& problem);

  /// Returns the string with this name; null if there is none.
  PACINIANCORE_API const std::string* text(std::string_view name) const;

  /// Returns the integer with this name, if there is one.
  PACINIANCORE_API std::optional<std::int64_t> integer(std::string_view name) const;

 private:
  using Value = std::variant<std::monostate, std::string, std::int64_t>;
  const Value* find(std::string_view name) const;

  std::vector<std::pair<std::string, Value>> members_;
};

}  // namespace pacinian::wire
