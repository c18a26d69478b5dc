#include "command.h"

#include <algorithm>
#include <cstdint>

namespace pacinian::zmtp::command {

namespace {

constexpr std::string_view misspelt_error = "^RROR";
constexpr std::size_t size_bytes = 4;  // of a property's size

Data strip(std::string_view text, std::string_view prefix) {
  if (text.substr(0, prefix.size()) != prefix) return std::nullopt;
  return text.substr(prefix.size());
}

char lower(char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; }

bool is_same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

std::uint32_t read_size(std::string_view data) {
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < size_bytes; ++i) size = size << 8 | static_cast<std::uint8_t>(data[i]);
  return size;
}

}  // namespace

Data match(const FrameReader& frame, std::string_view name) {
  const std::string_view body = frame.body();
  if (!frame.is_command() || body.empty() || static_cast<std::uint8_t>(body[0]) != name.size()) return std::nullopt;
  return strip(body.substr(1), name);
}

Data match_error(const FrameReader& frame) {
  const Data data = match(frame, error);
  return data || !frame.is_command() ? data : strip(frame.body(), misspelt_error);
}

Data read_text(std::string_view data) {
  if (data.empty() || static_cast<std::uint8_t>(data[0]) > data.size() - 1) return std::nullopt;
  return data.substr(1, static_cast<std::uint8_t>(data[0]));
}

Data find_property(std::string_view properties, std::string_view name) {
  std::string_view found;
  while (!properties.empty()) {
    const Data key = read_text(properties);
    if (!key || key->empty()) return std::nullopt;
    properties.remove_prefix(1 + key->size());
    if (properties.size() < size_bytes) return std::nullopt;
    const std::uint32_t size = read_size(properties);
    properties.remove_prefix(size_bytes);
    if (size > properties.size()) return std::nullopt;
    if (is_same_name(*key, name)) found = properties.substr(0, size);
    properties.remove_prefix(size);
  }
  return found;
}

std::string make_printable(std::string_view text) {
  std::string made(text);
  std::replace_if(made.begin(), made.end(), [](char letter) { return letter < ' ' || letter > '~'; }, '?');
  return made;
}

std::string write_properties(std::initializer_list<std::pair<std::string_view, std::string_view>> properties) {
  std::string made;
  for (const auto& [name, value] : properties) {
    made += static_cast<char>(name.size());
    made += name;
    for (int shift = 24; shift >= 0; shift -= 8) made += static_cast<char>(value.size() >> shift & 0xff);
    made += value;
  }
  return made;
}

}  // namespace pacinian::zmtp::command
