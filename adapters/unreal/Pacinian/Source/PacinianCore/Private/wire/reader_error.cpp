#include "pacinian/wire/reader.h"

namespace pacinian::wire {

namespace {

constexpr std::size_t longest_path = 200;  // [bytes] in a message

}  // namespace

bool Reader::wrong(std::string problem) {
  problem_ = std::move(problem);
  return false;
}

bool Reader::broken(const char* problem) {
  problem_ = problem;
  whole_ = true;
  return false;
}

bool Reader::missing(std::string_view name) {
  problem_ = "is missing";
  return at(name);
}

bool Reader::unknown_tag() {
  problem_ = "is no type that can be here";
  return at("type");
}

bool Reader::at(std::string_view name) {
  if (!whole_) path_.insert(0, ".").insert(1, name);
  return false;
}

bool Reader::at(std::uint32_t index) {
  if (!whole_) path_.insert(0, "[" + std::to_string(index) + "]");
  return false;
}

bool Reader::at_entry() {
  if (!whole_) path_.insert(0, "[...]");
  return false;
}

WireError Reader::error() const { return {problem_, ("$" + path_).substr(0, longest_path)}; }

}  // namespace pacinian::wire
