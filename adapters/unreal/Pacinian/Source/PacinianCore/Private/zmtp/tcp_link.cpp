#include "tcp_link.h"

namespace pacinian::zmtp {

namespace {

constexpr int max_reads = 16;  // for a peer that sends without end

}  // namespace

TcpLink::~TcpLink() {
  if (handle_ != native::no_handle) native::close(handle_);
}

void TcpLink::try_connect() {
  if (is_connected_ || is_closed_) return;
  native::Watch watched = watch(false);
  native::wait(&watched, 1, 0.0);
  if (!watched.is_ready) return;
  is_connected_ = native::is_connected(handle_);
  is_closed_ = !is_connected_;
}

bool TcpLink::read(FrameReader& input) {
  bool has_some = false;
  for (int i = 0; i < max_reads && is_connected_ && !is_closed_; ++i) {
    const FrameReader::Room room = input.reserve();
    if (room.size == 0) break;
    const native::Moved got = native::receive(handle_, room.data, room.size);
    if (!got || *got == 0) {
      is_closed_ = !got || is_broken_;
      break;
    }
    input.add(*got);
    has_some = true;
    if (*got < room.size) break;
  }
  return has_some;
}

void TcpLink::write(FrameWriter& output) {
  while (output.size() > 0 && is_connected_ && !is_broken_ && !is_closed_) {
    const native::Moved sent = native::send(handle_, output.data(), output.size());
    is_broken_ = !sent;
    if (!sent || *sent == 0) return;
    output.mark_sent(*sent);
  }
}

}  // namespace pacinian::zmtp
