#pragma once

#include <cstdint>

namespace pacinian::zmtp {

/// How a connection has ended.
enum class Ending : std::uint8_t {
  none,     ///< it has not ended
  nobody,   ///< no program listens at the address
  gone,     ///< the peer closed the connection, or is gone
  denied,   ///< the peer rejected the token or key
  foreign,  ///< the peer is not a Pacinian server, or uses another security mechanism
};

}  // namespace pacinian::zmtp
