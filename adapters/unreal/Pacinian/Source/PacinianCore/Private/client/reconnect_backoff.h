#pragma once

#include <string>

#include "connection_failure.h"
#include "pacinian/client/events.h"

namespace pacinian::client {

/// Decides when to connect, and what to report until then. Does not read a clock: times are arguments [s].
class ReconnectBackoff {
 public:
  static constexpr double shortest = 0.1, longest = 2.0;  ///< [s] pauses
  static constexpr double unasked = 0.5;  ///< [s] longest pause if no server was asked, because reading a file costs little

  Status status() const { return status_; }
  const std::string& problem() const { return problem_; }

  /// Returns when the next attempt is due.
  double due() const { return due_; }

  void record_success();

  /// Records that an attempt failed, or that a session was lost. most: the longest pause before the next attempt [s].
  void record_failure(const ConnectionFailure& loss, double now, double most = longest);

 private:
  Status status_ = Status::connecting;
  std::string problem_;
  double due_ = 0.0, pause_ = shortest;
};

}  // namespace pacinian::client
