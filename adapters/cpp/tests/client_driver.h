#pragma once

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <string>
#include <utility>

namespace driver {

/// Returns a text as JSON.
inline std::string quoted(const std::string& text) {
  std::string made = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') made += '\\';
    made += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return made + '"';
}

/// A value of a JSON object.
struct Value {
  Value(const std::string& value) : text(quoted(value)) {}
  Value(const char* value) : text(quoted(value)) {}
  Value(bool value) : text(value ? "true" : "false") {}
  Value(std::int64_t value) : text(std::to_string(value)) {}
  Value(std::size_t value) : text(std::to_string(value)) {}
  Value(int value) : text(std::to_string(value)) {}
  Value(double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.9g", value);
    text = digits;
  }
  std::string text;
};

using Pairs = std::initializer_list<std::pair<const char*, Value>>;

inline std::string object(Pairs pairs) {
  std::string made;
  for (const auto& [name, value] : pairs)
    made += (made.empty() ? "{" : ", ") + quoted(name) + ": " + value.text;
  return made + "}";
}

/// Prints a JSON object as a line.
inline void say(Pairs pairs) {
  std::puts(object(pairs).c_str());
  std::fflush(stdout);
}

}  // namespace driver
