#pragma once

#include <string>

#include "connection_failure.h"
#include "pacinian/client/events.h"

namespace pacinian::client {

/// When to connect, and what people are told until it is done: pure, with the time given [s].
class ReconnectBackoff {
 public:
  static constexpr double shortest = 0.1, longest = 2.0;  ///< [s] between two
  static constexpr double unasked = 0.5;  ///< [s] at most, if no server was asked: a look at a file costs little

  Status status() const { return status_; }
  const std::string& problem() const { return problem_; }

  /// When the next one is to begin.
  double due() const { return due_; }

  void succeeded();

  /// One failed, or a session was lost. most: the longest pause before the next [s].
  void failed(const ConnectionFailure& loss, double now, double most = longest);

 private:
  Status status_ = Status::connecting;
  std::string problem_;
  double due_ = 0.0, pause_ = shortest;
};

}  // namespace pacinian::client
