#include "object_validation.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <type_traits>
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

/// What is wrong although each field is in its range. path: from the object on; null if nothing is wrong.
struct Flaw {
  const char* path = nullptr;
  const char* message = nullptr;
};

template <class T>
Flaw find_flaw(const T&) {
  return {};
}

template <class T>
Flaw check_levels(const T& wave) {
  return wave.high < wave.low ? Flaw{".envelope.high", "must be at least `low`"} : Flaw{};
}

Flaw find_flaw(const wire::Sine& wave) { return check_levels(wave); }

Flaw find_flaw(const wire::Square& wave) { return check_levels(wave); }

Flaw find_flaw(const wire::Pulse& wave) {
  if (wave.rise > 0.5 * wave.width) return {".envelope.rise", "must be at most half of the width"};
  if (wave.period && *wave.period < wave.width) return {".envelope.period", "must be at least the width"};
  return check_levels(wave);
}

Flaw find_flaw(const wire::Noise& wave) {
  if (wave.low_frequency > 0.99 * wave.high_frequency)
    return {".envelope.low_frequency", "must be at least 1 % below `high_frequency`"};
  return check_levels(wave);
}

Flaw find_flaw(const wire::STM& technique) {
  const double period = 1.0 / technique.frequency;
  const bool good = !technique.dwell || (*technique.dwell >= period / 10'000.0 && *technique.dwell <= period);
  return good ? Flaw{} : Flaw{".technique.dwell", "must be from 1/10000 of the period, 1 / `frequency`, to the period"};
}

Flaw find_flaw(const wire::Pose& pose) {
  const auto& turn = pose.rotation;
  const double length = std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3]));
  return std::fabs(length - 1.0) > 0.01 ? Flaw{".pose.rotation", "must be a quaternion of length 1"} : Flaw{};
}

Flaw find_flaw_of_object(const wire::Object& object) {
  const auto look = [](const auto& part) { return find_flaw(part); };
  return std::visit([&look](const auto& felt) {
    Flaw flaw = std::visit(look, felt.envelope);
    if (!flaw.path && felt.technique) flaw = std::visit(look, *felt.technique);
    if constexpr (!std::is_same_v<std::decay_t<decltype(felt)>, wire::Point>)
      if (!flaw.path) flaw = find_flaw(felt.pose);
    return flaw;
  }, object);
}

}  // namespace

bool is_name(std::string_view name) {
  const std::int64_t characters = wire::utf8_length(name);
  return characters > 0 && characters <= longest;
}

bool refuse(std::string_view name, const wire::Object& object, double most, Refusal& why) {
  why = {"argument", "", "$.objects[" + std::string(name) + "]", ""};
  if (!is_name(name)) {
    why.message = "must have a name of 1 to " + std::to_string(longest) + " characters in UTF-8";
    return true;
  }
  if (!has_one_strength(object)) {
    why.message = "must have a radiation pressure or a force, and not both";
    return true;
  }
  const double pressure = std::visit([](const auto& felt) { return felt.radiation_pressure.value_or(0.0); }, object);
  if (pressure > most) {
    char text[80];
    std::snprintf(text, sizeof text, "makes a radiation pressure of %.4g Pa: keep to %g Pa", pressure, most);
    why.code = "limit";
    why.message = text;
    why.path += ".radiation_pressure";
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
  if (reader.one_of(again) && reader.done()) {
    const Flaw flaw = find_flaw_of_object(object);
    if (!flaw.path) return false;
    why.message = flaw.message;
    why.path += flaw.path;
    return true;
  }
  const wire::WireError error = reader.error();
  why.message = error.problem;
  if (!error.path.empty()) why.path += error.path.substr(1);  // after "$"
  return true;
}

}  // namespace pacinian::client
