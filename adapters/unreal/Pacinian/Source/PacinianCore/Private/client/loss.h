#pragma once

#include <string>

namespace pacinian::client {

/// Why there is no connection. refused: not before something is changed will there be one.
struct Loss {
  std::string why;
  bool refused = false;
};

}  // namespace pacinian::client
