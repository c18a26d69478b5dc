#pragma once

#include <string>

#include "connection_failure.h"
#include "pacinian/client/events.h"

namespace pacinian::client {

/// Decides when to connect, and what to report until then. Does not read a clock: times are arguments [s].
class ReconnectBackoff {
 public:
  static constexpr double min_pause = 0.1, max_pause = 2.0;  ///< [s]
  /// Limit if an attempt reached no server [s]. It is shorter, because such an attempt costs little.
  static constexpr double max_pause_without_server = 0.5;

  Status status() const { return status_; }
  const std::string& problem() const { return problem_; }

  /// Returns when the next attempt is due.
  double due() const { return due_; }

  void record_success();

  /// Records that an attempt failed, or that a session was lost. If the problem differs from the previous problem, the
  /// pauses begin again at min_pause. limit: upper limit of the later pauses [s].
  void record_failure(const ConnectionFailure& loss, double now, double limit = max_pause);

 private:
  Status status_ = Status::connecting;
  std::string problem_;
  double due_ = 0.0, pause_ = min_pause;
};

}  // namespace pacinian::client
