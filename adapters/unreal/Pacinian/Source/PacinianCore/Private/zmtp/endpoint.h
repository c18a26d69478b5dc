#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pacinian::zmtp {

/// An address of IPv4 or IPv6, and a port.
struct Endpoint {
  bool is_v6 = false;
  std::array<std::uint8_t, 16> address{};  ///< in the network's order; of IPv4 the first four
  std::uint16_t port = 0;

  /// Whether it is on this machine.
  bool is_loopback() const;
};

/// Reads `tcp://ADDRESS:PORT`, where the address is an IP address or `localhost`; nothing if it is none.
std::optional<Endpoint> read_endpoint(std::string_view text);

}  // namespace pacinian::zmtp
