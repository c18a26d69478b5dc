#pragma once

#include <vector>

#include "pacinian/client/events.h"
#include "pacinian/wire/state.h"

namespace pacinian::client {

/// Compares the touches of the newest state with those before, so that a lost state loses no end of a touch. Allocates
/// nothing for touches that continue.
class Touches {
 public:
  /// Reports touches that ended, began or moved, until `clear` is called. state: null if all touches end.
  void report_changes(const wire::State* state, const Events& on);

  void clear();

  const std::vector<wire::TouchState>& now() const { return now_; }

 private:
  std::vector<wire::TouchState> now_;
  int cleared_ = 0;  ///< number of calls of `clear`
};

}  // namespace pacinian::client
