#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pacinian::wire {

/// Returns the number of code points (RFC 3629: no surrogates, no overlong forms); -1 if the text is not UTF-8.
std::int64_t utf8_length(std::string_view text);

/// Appends a code point. A lone surrogate, which no text can contain, is appended as invalid UTF-8.
void utf8_append(std::string& out, std::uint32_t code);

}  // namespace pacinian::wire
