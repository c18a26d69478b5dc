#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pacinian::client {

using Digest = std::array<std::uint8_t, 32>;

/// Returns the SHA-256 of some bytes (FIPS 180-4).
Digest sha256(const std::vector<std::uint8_t>& data);

/// Returns the HMAC of some bytes with SHA-256 (RFC 2104).
Digest hmac_sha256(const std::string& key, const std::vector<std::uint8_t>& data);

}  // namespace pacinian::client
