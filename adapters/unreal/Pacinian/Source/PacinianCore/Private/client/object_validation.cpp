#include "object_validation.h"

#include <cstdint>
#include <string>
#include <variant>

#include "pacinian/wire/reader.h"
#include "pacinian/wire/writer.h"
#include "wire/utf8.h"

namespace pacinian::client {

namespace {

constexpr std::int64_t longest = 64;  // characters of a name

bool has_one_strength(const wire::Object& object) {
  return std::visit([](const auto& felt) { return felt.radiation_pressure.has_value() != felt.force.has_value(); }, object);
}

}  // namespace

bool is_name(std::string_view name) {
  const std::int64_t characters = wire::utf8_length(name);
  return characters > 0 && characters <= longest;
}

bool refuse(std::string_view name, const wire::Object& object, Refusal& why) {
  why = {"argument", "", "$.objects[" + std::string(name) + "]", ""};
  if (!is_name(name)) {
    why.message = "must have a name of 1 to " + std::to_string(longest) + " characters in UTF-8";
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
