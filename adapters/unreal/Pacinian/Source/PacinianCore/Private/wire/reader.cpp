#include "pacinian/wire/reader.h"

#include <string>

#include "head.h"
#include "utf8.h"

namespace pacinian::wire {

namespace {

constexpr const char* cut_short = "is cut short";
constexpr const char* no_utf8 = "has text that is not UTF-8";
constexpr const char* names[] = {"never used",  // in the texts of problems
                                 "nil", "bool", "int", "float", "text", "bin", "array", "map",
                                 "extension"};

const char* name_of(Kind kind) { return names[static_cast<std::size_t>(kind)]; }

/// Formats a number without trailing zeros.
std::string told(double value) {
  std::string text = std::to_string(value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string told(Lengths lengths) {
  const std::string least = std::to_string(lengths.least), most = std::to_string(lengths.most);
  if (lengths.least == lengths.most) return most;
  return lengths.most == Lengths{}.most ? "at least " + least : least + " to " + most;
}

}  // namespace

Kind Reader::next() const { return next_ == end_ ? Kind::none : kind_of(*next_); }

bool Reader::done() { return next_ == end_ || broken("has more bytes than the message"); }

bool Reader::take(Head& out) {
  if (!out.read(next_, end_) || !out.find_body(next_, end_)) return broken(cut_short);
  return out.kind != Kind::none || broken("has a byte that is never used");
}

bool Reader::take(Head& out, Kind wanted) {
  if (!take(out)) return false;
  if (out.kind == wanted) return true;
  return wrong(std::string("must be ") + name_of(wanted) + ", not " + name_of(out.kind));
}

bool Reader::nil() {
  if (next() != Kind::nil) return false;
  ++next_;
  return true;
}

bool Reader::get(bool& out) {
  Head head;
  if (!take(head, Kind::boolean)) return false;
  out = head.boolean;
  return true;
}

bool Reader::get(double& out, Range range) {
  Head head;
  if (!take(head, next() == Kind::integer ? Kind::integer : Kind::real)) return false;
  out = head.number();
  if (range.has(out)) return true;
  return wrong(std::string("must be ") + (range.open ? "more than " : "from ") + told(range.low) +
               (range.open ? ", at most " : " to ") + told(range.high));
}

bool Reader::get(std::int64_t& out, std::int64_t low, std::int64_t high) {
  Head head;
  if (!take(head, Kind::integer)) return false;
  out = head.integer();
  if (!head.huge && out >= low && out <= high) return true;
  return wrong("must be from " + std::to_string(low) + " to " + std::to_string(high));
}

bool Reader::word(std::string_view& out) {
  Head head;
  if (!take(head, Kind::text)) return false;
  out = {reinterpret_cast<const char*>(head.body), head.size};
  return utf8_length(out) >= 0 || broken(no_utf8);
}

bool Reader::get(std::string& out, Lengths characters) {
  Head head;
  if (!take(head, Kind::text)) return false;
  const std::string_view text(reinterpret_cast<const char*>(head.body), head.size);
  const std::int64_t count = utf8_length(text);
  if (count < 0) return broken(no_utf8);
  const auto length = static_cast<std::size_t>(count);
  if (length < characters.least || length > characters.most)
    return wrong("must be text of " + told(characters) + " characters");
  out.assign(text);
  return true;
}

bool Reader::get(Bytes& out, Lengths lengths) {
  Head head;
  if (next() != Kind::bin) return take(head, Kind::bin);
  if (!head.read(next_, end_)) return broken(cut_short);
  if (head.size < lengths.least || head.size > lengths.most)
    return wrong("must be bin of " + told(lengths) + " bytes");
  if (!head.find_body(next_, end_)) return broken(cut_short);
  out.assign(head.body, head.body + head.size);
  return true;
}

bool Reader::array(std::uint32_t& count, Lengths lengths) {
  Head head;
  if (!take(head, Kind::array)) return false;
  count = head.size;
  if (count < lengths.least || count > lengths.most)
    return wrong("must be an array of " + told(lengths));
  return true;
}

bool Reader::map(std::uint32_t& count, Lengths lengths) {
  Head head;
  if (!take(head, Kind::map)) return false;
  count = head.size;
  if (count < lengths.least || count > lengths.most)
    return wrong("must be a map of " + told(lengths));
  return true;
}

bool Reader::key(std::string_view& out) {
  Head head;
  if (next_ != end_ && next() != Kind::text)
    return wrong(std::string("must be text, not ") + name_of(next()));
  if (!take(head)) return false;
  out = {reinterpret_cast<const char*>(head.body), head.size};
  return true;
}

bool Reader::skip() {
  std::uint64_t left = 1;
  for (Head head; left > 0; --left) {
    if (!take(head)) return false;
    left += head.children();
    if (left - 1 > static_cast<std::size_t>(end_ - next_)) return broken(cut_short);
  }
  return true;
}

bool Reader::open(std::string_view& tag, std::uint32_t& left) {
  std::uint32_t count = 0;
  if (!map(count)) return false;
  const std::uint8_t* const first = next_;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::string_view name;
    if (!key(name)) return false;
    if (name != "type") {
      if (!skip()) return false;
      continue;
    }
    if (!key(tag)) return at("type");
    if (utf8_length(tag) < 0) return broken(no_utf8);
    left = i == 0 ? count - 1 : count;
    if (i > 0) next_ = first;
    return true;
  }
  return missing("type");
}

bool Reader::same(std::string_view tag) {
  std::string_view found;
  if (!key(found)) return false;
  if (utf8_length(found) < 0) return broken(no_utf8);
  return found == tag || wrong("must be " + std::string(tag));
}

}  // namespace pacinian::wire
