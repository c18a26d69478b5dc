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
  std::string name = "game";  ///< of the client, shown to people: 1 to 64 characters
  /// Clients with the same name share a scene; empty: a scene of its own. 64 characters at most.
  std::string scene;
  /// From the last tick to silence [s], 0.05 to 10; by default, and at most, the longest that the server allows.
  std::optional<double> lease;
  std::string version;  ///< of the game, shown to people: 200 characters at most
  /// Time to live of a command [s], more than 0 and at most 60: the server drops it if it would apply it later.
  double life = 1.0;
  double timeout = 2.0;  ///< for an answer [s], more than 0
  std::function<double()> clock = steady_clock;  ///< both threads call it
};

}  // namespace pacinian
