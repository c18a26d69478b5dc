#pragma once

#include <cstddef>
#include <cstdint>

/// Bits of a frame's first byte (RFC 37, "Framing").
namespace pacinian::zmtp::frame {

constexpr std::uint8_t more = 1, has_long_size = 2, is_command = 4, reserved = 0xf8;

constexpr std::size_t max_short_size = 255;           // [bytes] of a body whose size is one byte
constexpr std::size_t short_head = 2, long_head = 9;  // [bytes] before the body

}  // namespace pacinian::zmtp::frame
