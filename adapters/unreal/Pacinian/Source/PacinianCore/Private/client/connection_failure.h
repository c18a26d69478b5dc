#pragma once

#include <string>

#include "zmtp/ending.h"

namespace pacinian::client {

using zmtp::Ending;

/// Why there is no connection. refused: not before something is changed will there be one.
struct ConnectionFailure {
  std::string why;
  bool refused = false;
};

/// Why a connection to that address has ended. is_known: whether its server has answered before, on this connection or
/// another.
ConnectionFailure explain(Ending how, const std::string& at, bool is_known);

}  // namespace pacinian::client
