#include "reconnect_backoff.h"

#include <algorithm>

namespace pacinian::client {

void ReconnectBackoff::record_success() {
  status_ = Status::connected;
  problem_.clear();
  pause_ = shortest;
}

void ReconnectBackoff::record_failure(const ConnectionFailure& loss, double now, double most) {
  if (loss.why != problem_) pause_ = shortest;  // something has changed
  status_ = loss.refused ? Status::refused : Status::connecting;
  problem_ = loss.why;
  due_ = now + pause_;
  pause_ = std::min(2.0 * pause_, most);
}

}  // namespace pacinian::client
