#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pacinian/api.h"

namespace pacinian {

/// A steady clock [s].
PACINIANCORE_API double steady_clock();

/// How to connect, and as whom.
struct Options {
  /// Unless given, that of PACINIAN_CONNECTION, or where the server writes it. Or the file's content, which begins with {: for a
  /// server whose files this program cannot read, as from a headset.
  std::string connection_path;
  std::string name = "game";    ///< of the client, for people
  std::string scene;            ///< clients of one name share a scene; one of its own unless given
  std::optional<double> lease;  ///< from the last tick to silence [s]; at most, and unless given, the server's
  std::string version;          ///< of the client, for people
  double life = 1.0;            ///< what the server would do later than so long after it was asked is dropped [s]
  double timeout = 2.0;         ///< of an answer [s]
  std::function<double()> clock = steady_clock;  ///< asked by both threads
};

}  // namespace pacinian
