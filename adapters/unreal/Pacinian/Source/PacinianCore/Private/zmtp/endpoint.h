#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pacinian::zmtp {

/// An IPv4 or IPv6 address, and a port.
struct Endpoint {
  bool is_v6 = false;
  std::array<std::uint8_t, 16> address{};  ///< in network order; IPv4: the first four
  std::uint16_t port = 0;

  /// Returns whether the address is on this machine.
  bool is_loopback() const;
};

/// Parses `tcp://ADDRESS:PORT`, where ADDRESS is an IP address or `localhost`; returns nothing if the text is anything
/// else.
std::optional<Endpoint> read_endpoint(std::string_view text);

}  // namespace pacinian::zmtp
