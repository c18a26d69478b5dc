#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pacinian/api.h"

namespace pacinian {

/// Returns the time of a monotonic clock [s].
PACINIANCORE_API double steady_clock();

/// Options of a client.
struct Options {
  /// The path of the connection file; empty: the path in PACINIAN_CONNECTION, or the place where the server writes it.
  /// Or the content of the file, which begins with {, if the client cannot read the server's files, as on a headset.
  std::string connection_path;
  std::string name = "game";    ///< of the client, shown to people
  std::string scene;            ///< clients with the same name share a scene; empty: a scene of its own
  std::optional<double> lease;  ///< from the last tick to silence [s]; by default, the longest that the server allows
  std::string version;          ///< of the game, shown to people
  double life = 1.0;            ///< time to live of a command [s]: the server drops it if it would apply it later
  double timeout = 2.0;         ///< for an answer [s]
  std::function<double()> clock = steady_clock;  ///< both threads call it
};

}  // namespace pacinian
