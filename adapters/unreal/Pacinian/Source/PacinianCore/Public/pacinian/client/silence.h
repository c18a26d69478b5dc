#pragma once

#include <string>

namespace pacinian {

/// Why the output is silent for this client. The server finds it, but for what only a client knows.
struct Silence {
  /// For programs: a value of `cause` on the wire, "not connected" or "not the owner"; empty if it sounds.
  std::string cause;
  std::string text;  ///< for people: what is the matter, and what to do
};

}  // namespace pacinian
