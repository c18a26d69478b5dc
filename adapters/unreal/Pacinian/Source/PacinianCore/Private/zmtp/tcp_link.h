#pragma once

#include "frame_reader.h"
#include "frame_writer.h"
#include "native_socket.h"

namespace pacinian::zmtp {

/// A TCP connection that never waits. Belongs to one thread.
class TcpLink {
 public:
  /// Begins to connect.
  explicit TcpLink(const Endpoint& to) : handle_(native::connect(to)), is_closed_(handle_ == native::no_handle) {}
  ~TcpLink();
  TcpLink(const TcpLink&) = delete;
  TcpLink& operator=(const TcpLink&) = delete;

  /// Whether it was connected.
  bool is_connected() const { return is_connected_; }

  /// Whether it could not be connected, or the peer has closed it and all that came is read.
  bool is_closed() const { return is_closed_; }

  /// Looks whether it is connected by now.
  void try_connect();

  /// Takes in what has come; whether that was something.
  bool read(FrameReader& input);

  /// Sends as much as there is room for.
  void write(FrameWriter& output);

  /// What ends a wait: that it is connected, something has come, or there is room to send.
  native::Watch watch(bool has_output) const { return {handle_, is_connected_, !is_connected_ || has_output, false}; }

 private:
  native::Handle handle_;
  bool is_connected_ = false, is_closed_ = false;
  bool is_broken_ = false;  // nothing can be sent; what has come can still be read
};

}  // namespace pacinian::zmtp
