#include "reconnect_backoff.h"

#include <algorithm>

namespace pacinian::client {

void ReconnectBackoff::record_success() {
  status_ = Status::connected;
  problem_.clear();
  pause_ = min_pause;
}

void ReconnectBackoff::record_failure(const ConnectionFailure& loss, double now, double limit) {
  if (loss.why != problem_) pause_ = min_pause;
  status_ = loss.refused ? Status::refused : Status::connecting;
  problem_ = loss.why;
  due_ = now + pause_;
  pause_ = std::min(2.0 * pause_, limit);
}

}  // namespace pacinian::client
