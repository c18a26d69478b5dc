#include "connection_failure.h"

namespace pacinian::client {

ConnectionFailure explain(Ending how, const std::string& at, bool is_known) {
  const std::string server = "the server at " + at + " ";
  if (how == Ending::denied)
    return {server + "refuses the token or key: it does not know it, or was started again since", true};
  if (is_known || how == Ending::gone) return {server + "has gone", false};  // also during a handshake
  if (how == Ending::foreign)
    return {server + "is no Pacinian server, wants other security (CURVE keys or a token), or is too busy", true};
  return {server + "does not answer: is `pacinian serve` running?", false};
}

}  // namespace pacinian::client
