#ifndef _WIN32

#include <fcntl.h>
#include <unistd.h>

#include "wake_event.h"

namespace pacinian::client {

namespace {

constexpr std::size_t max_rings = 256;  // that one read clears

void set_up(int end) {
  ::fcntl(end, F_SETFL, ::fcntl(end, F_GETFL) | O_NONBLOCK);
  ::fcntl(end, F_SETFD, FD_CLOEXEC);
}

}  // namespace

/// Uses a pipe. If there is none, because a process may have only so many files, waits end when their time is over.
WakeEvent::WakeEvent() {
  int ends[2];
  if (::pipe(ends) != 0) return;
  inside_ = ends[0];
  outside_ = ends[1];
  set_up(inside_);
  set_up(outside_);
}

WakeEvent::~WakeEvent() {
  if (inside_ == zmtp::native::no_handle) return;
  ::close(inside_);
  ::close(outside_);
}

void WakeEvent::set() {
  const char ring = 0;
  [[maybe_unused]] const ssize_t written = ::write(outside_, &ring, 1);  // a full pipe is readable already
}

void WakeEvent::clear() {
  char rings[max_rings];
  while (::read(inside_, rings, sizeof rings) == static_cast<ssize_t>(sizeof rings)) {
  }
}

}  // namespace pacinian::client

#endif
