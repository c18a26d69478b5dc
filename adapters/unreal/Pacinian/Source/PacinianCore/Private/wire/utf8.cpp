#include "utf8.h"

namespace pacinian::wire {

namespace {

constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};  // the smallest code point that needs so many bytes

/// Returns the number of bytes of a character with this first byte; 0 if there is none.
int width(unsigned char first) {
  if (first < 0x80) return 1;
  if (first < 0xC0) return 0;
  if (first < 0xE0) return 2;
  if (first < 0xF0) return 3;
  return first < 0xF8 ? 4 : 0;
}

}  // namespace

std::int64_t utf8_length(std::string_view text) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < text.size(); ++count) {
    const auto first = static_cast<unsigned char>(text[i]);
    const int bytes = width(first);
    if (bytes == 0 || text.size() - i < static_cast<std::size_t>(bytes)) return -1;
    std::uint32_t code = bytes == 1 ? first : first & (0xFFu >> (bytes + 1));
    for (int k = 1; k < bytes; ++k) {
      const auto next = static_cast<unsigned char>(text[i + static_cast<std::size_t>(k)]);
      if ((next & 0xC0) != 0x80) return -1;
      code = (code << 6) | (next & 0x3Fu);
    }
    if (code < least[bytes] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) return -1;
    i += static_cast<std::size_t>(bytes);
  }
  return count;
}

void utf8_append(std::string& out, std::uint32_t code) {
  int bytes = 1;
  while (bytes < 4 && code >= least[bytes + 1]) ++bytes;
  if (bytes == 1) {
    out.push_back(static_cast<char>(code));
    return;
  }
  out.push_back(static_cast<char>((0xF00u >> bytes) | (code >> (6 * (bytes - 1)))));
  for (int k = bytes - 2; k >= 0; --k)
    out.push_back(static_cast<char>(0x80u | ((code >> (6 * k)) & 0x3Fu)));
}

}  // namespace pacinian::wire
