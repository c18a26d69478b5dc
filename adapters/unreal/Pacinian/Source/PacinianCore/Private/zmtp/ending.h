#pragma once

#include <cstdint>

namespace pacinian::zmtp {

/// How a connection has ended.
enum class Ending : std::uint8_t {
  none,     ///< it has not
  nobody,   ///< nobody listens there
  gone,     ///< the peer was there, and has gone
  denied,   ///< the peer refuses the token or key
  foreign,  ///< the peer is no Pacinian server, or wants other security
};

}  // namespace pacinian::zmtp
