#include "attempts.h"

#include <algorithm>

namespace pacinian::client {

void Attempts::succeeded() {
  status_ = Status::connected;
  problem_.clear();
  pause_ = shortest;
}

void Attempts::failed(const Loss& loss, double now) {
  if (loss.why != problem_) pause_ = shortest;  // something has changed
  status_ = loss.refused ? Status::refused : Status::connecting;
  problem_ = loss.why;
  due_ = now + pause_;
  pause_ = std::min(2.0 * pause_, longest);
}

}  // namespace pacinian::client
