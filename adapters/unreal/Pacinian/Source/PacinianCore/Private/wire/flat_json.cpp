#include "pacinian/wire/flat_json.h"

#include <charconv>

#include "json_scanner.h"

namespace pacinian::wire {

bool FlatJson::parse(std::string_view text, std::string& problem) {
  members_.clear();
  JsonScanner in(text);
  bool good = text.size() <= longest && in.take('{');
  if (good && !in.take('}')) {
    do {
      std::string name;
      good = in.string(name) && in.take(':');
      Value value;
      std::string word;
      if (good && in.at('"')) {
        good = in.string(word);
        value = std::move(word);
      } else if (good) {
        std::string_view token;
        good = in.skip(deepest, token);
        std::int64_t number = 0;
        const char* const last = token.data() + token.size();
        const auto [end, error] = std::from_chars(token.data(), last, number);
        if (error == std::errc() && end == last) value = number;
      }
      members_.emplace_back(std::move(name), std::move(value));
    } while (good && in.take(','));
    good = good && in.take('}');
  }
  if (good && in.done()) return true;
  members_.clear();
  problem = "is no JSON object: wrong at byte " + std::to_string(in.position());
  return false;
}

const FlatJson::Value* FlatJson::find(std::string_view name) const {
  for (auto member = members_.rbegin(); member != members_.rend(); ++member)  // the last one counts
    if (member->first == name) return &member->second;
  return nullptr;
}

const std::string* FlatJson::text(std::string_view name) const {
  return std::get_if<std::string>(find(name));
}

std::optional<std::int64_t> FlatJson::integer(std::string_view name) const {
  const auto* number = std::get_if<std::int64_t>(find(name));
  return number ? std::optional(*number) : std::nullopt;
}

}  // namespace pacinian::wire
