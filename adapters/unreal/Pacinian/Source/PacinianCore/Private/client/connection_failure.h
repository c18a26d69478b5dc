#pragma once

#include <string>

#include "zmtp/ending.h"

namespace pacinian::client {

using zmtp::Ending;

/// Why there is no connection. refused: there will be none until something is changed.
struct ConnectionFailure {
  std::string why;
  bool refused = false;
};

/// Explains why the connection to an address has ended. is_known: whether its server has answered before, on this
/// connection or another.
ConnectionFailure explain(Ending how, const std::string& at, bool is_known);

}  // namespace pacinian::client
