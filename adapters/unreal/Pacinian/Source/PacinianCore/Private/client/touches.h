#pragma once

#include <vector>

#include "pacinian/client/events.h"
#include "pacinian/wire/state.h"

namespace pacinian::client {

/// The touches of the newest state, compared with those before: a state that was lost loses no end. Nothing is
/// allocated for those that go on.
class Touches {
 public:
  /// Tells what has ended, begun and moved, until `clear` is called. state: null if nothing is touched any more.
  void follow(const wire::State* state, const Events& on);

  void clear();

  const std::vector<wire::TouchState>& now() const { return now_; }

 private:
  std::vector<wire::TouchState> now_;
  int cleared_ = 0;  ///< how often
};

}  // namespace pacinian::client
