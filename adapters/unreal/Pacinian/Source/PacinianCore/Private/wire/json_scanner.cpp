#include "json_scanner.h"

#include "utf8.h"

namespace pacinian::wire {

void JsonScanner::blank() {
  next_ = text_.find_first_not_of(" \t\r\n", next_);
  if (next_ == std::string_view::npos) next_ = text_.size();
}

bool JsonScanner::at(char mark) {
  blank();
  return next_ < text_.size() && text_[next_] == mark;
}

bool JsonScanner::take(char mark) {
  if (!at(mark)) return false;
  ++next_;
  return true;
}

bool JsonScanner::done() {
  blank();
  return next_ == text_.size();
}

bool JsonScanner::string(std::string& out) {
  out.clear();
  if (!take('"')) return false;
  while (next_ < text_.size()) {
    const char c = text_[next_++];
    if (c == '"') return utf8_length(out) >= 0;
    if (static_cast<unsigned char>(c) < 0x20) return false;
    if (c != '\\')
      out.push_back(c);
    else if (!escape(out))
      return false;
  }
  return false;
}

bool JsonScanner::escape(std::string& out) {
  static constexpr std::string_view from = "\"\\/bfnrt", to = "\"\\/\b\f\n\r\t";
  if (next_ >= text_.size()) return false;
  const char c = text_[next_++];
  if (const auto i = from.find(c); i != std::string_view::npos) {
    out.push_back(to[i]);
    return true;
  }
  unsigned code = 0, low = 0;
  if (c != 'u' || !hex(code)) return false;
  if (code >= 0xD800 && code < 0xDC00) {  // the first half of a pair
    if (text_.substr(next_, 2) != "\\u") return false;
    next_ += 2;
    if (!hex(low) || low < 0xDC00 || low > 0xDFFF) return false;
    code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
  }
  utf8_append(out, code);
  return true;
}

bool JsonScanner::hex(unsigned& out) {
  static constexpr std::string_view digits = "0123456789abcdef";
  if (text_.size() - next_ < 4) return false;
  for (int i = 0; i < 4; ++i) {
    const char c = text_[next_++];
    const auto digit = digits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c + 32) : c);
    if (digit == std::string_view::npos) return false;
    out = 16 * out + static_cast<unsigned>(digit);
  }
  return true;
}

std::size_t JsonScanner::digits() {
  const std::size_t start = next_;
  while (next_ < text_.size() && text_[next_] >= '0' && text_[next_] <= '9') ++next_;
  return next_ - start;
}

bool JsonScanner::number() {
  const auto here = [this](std::string_view any) {
    return next_ < text_.size() && any.find(text_[next_]) != std::string_view::npos;
  };
  if (here("-")) ++next_;
  const bool zero = here("0");
  const std::size_t whole = digits();
  if (whole == 0 || (zero && whole > 1)) return false;
  if (here(".") && (++next_, digits() == 0)) return false;
  if (!here("eE")) return true;
  ++next_;
  if (here("+-")) ++next_;
  return digits() > 0;
}

bool JsonScanner::members(int depth, char close, bool named) {
  std::string name;
  std::string_view token;
  if (take(close)) return true;
  do {
    if (named && !(string(name) && take(':'))) return false;
    if (!skip(depth - 1, token)) return false;
  } while (take(','));
  return take(close);
}

bool JsonScanner::skip(int depth, std::string_view& token) {
  blank();
  const std::size_t start = next_;
  std::string unused;
  bool good = depth > 0 && next_ < text_.size();
  if (good && at('"'))
    good = string(unused);
  else if (good && take('['))
    good = members(depth, ']', false);
  else if (good && take('{'))
    good = members(depth, '}', true);
  else if (good) {
    good = false;
    for (const std::string_view word : {"true", "false", "null"})
      if (text_.substr(start, word.size()) == word) {
        next_ += word.size();
        good = true;
      }
    good = good || number();
  }
  token = text_.substr(start, next_ - start);
  return good;
}

}  // namespace pacinian::wire
