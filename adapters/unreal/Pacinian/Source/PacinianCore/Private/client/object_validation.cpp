#include "object_validation.h"

#include <algorithm>
#include <string>
#include <variant>

#include "pacinian/wire/reader.h"
#include "pacinian/wire/writer.h"

namespace pacinian::client {

namespace {

constexpr std::ptrdiff_t longest = 64;  // characters of a name

/// Returns the number of code points in UTF-8: of all bytes except continuation bytes.
std::ptrdiff_t characters(std::string_view text) {
  return std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

bool has_one_strength(const wire::Object& object) {
  return std::visit([](const auto& felt) { return felt.radiation_pressure.has_value() != felt.force.has_value(); }, object);
}

}  // namespace

bool refuse(std::string_view name, const wire::Object& object, Refusal& why) {
  why = {"argument", "", "$.objects[" + std::string(name) + "]", ""};
  if (name.empty() || characters(name) > longest) {
    why.message = "must have a name of 1 to " + std::to_string(longest) + " characters";
    return true;
  }
  if (!has_one_strength(object)) {
    why.message = "must have a radiation pressure or a force, and not both";
    return true;
  }
  wire::Writer writer;
  writer.put(object);
  if (writer.size() > largest) {
    why.code = "limit";
    why.message = "is " + std::to_string(writer.size()) + " bytes: keep to " + std::to_string(largest);
    why.advice = "use fewer points, faces or values";
    return true;
  }
  wire::Reader reader(writer.data(), writer.size());
  wire::Object again;
  if (reader.one_of(again) && reader.done()) return false;
  const wire::WireError error = reader.error();
  why.message = error.problem;
  if (!error.path.empty()) why.path += error.path.substr(1);  // after "$"
  return true;
}

}  // namespace pacinian::client
