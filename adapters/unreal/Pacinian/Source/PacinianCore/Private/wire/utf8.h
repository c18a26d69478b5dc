#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pacinian::wire {

/// How many characters a UTF-8 text has (RFC 3629: no surrogates, no longer forms); -1 if it is not UTF-8.
std::int64_t utf8_length(std::string_view text);

/// Appends a character; a lone surrogate, which no text can hold, as bytes that are no UTF-8.
void utf8_append(std::string& out, std::uint32_t code);

}  // namespace pacinian::wire
