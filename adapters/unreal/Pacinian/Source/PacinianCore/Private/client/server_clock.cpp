#include "server_clock.h"

#include <algorithm>

namespace pacinian::client {

void ServerClock::add_round_trip(double sent, double received) {
  round_trips_[answers_++ % round_trips_.size()] = received - sent;
  const std::size_t count = std::min(answers_, round_trips_.size()), last = count - 1;
  std::copy_n(round_trips_.begin(), count, ordered_.begin());
  std::sort(ordered_.begin(), ordered_.begin() + static_cast<std::ptrdiff_t>(count));
  summary_ = {ordered_[last / 2], ordered_[(99 * last + 50) / 100], ordered_[last]};
}

void ServerClock::add_mark(double sent, double received, double server) {
  marks_[looks_++ % marks_.size()] = {received - sent, server - (sent + received) / 2.0};
}

double ServerClock::offset() const {
  const std::size_t count = std::min(looks_, marks_.size());
  const auto end = marks_.begin() + static_cast<std::ptrdiff_t>(count);
  const auto best = std::min_element(
      marks_.begin(), end, [](const Mark& a, const Mark& b) { return a.round_trip < b.round_trip; });
  return best == end ? 0.0 : best->offset;
}

}  // namespace pacinian::client
