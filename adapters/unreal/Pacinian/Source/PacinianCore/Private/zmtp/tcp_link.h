#pragma once

#include "frame_reader.h"
#include "frame_writer.h"
#include "native_socket.h"

namespace pacinian::zmtp {

/// A TCP connection that never blocks. Belongs to one thread.
class TcpLink {
 public:
  /// Starts to connect.
  explicit TcpLink(const Endpoint& to) : handle_(native::connect(to)), is_closed_(handle_ == native::no_handle) {}
  ~TcpLink();
  TcpLink(const TcpLink&) = delete;
  TcpLink& operator=(const TcpLink&) = delete;

  /// Returns whether the connection was established.
  bool is_connected() const { return is_connected_; }

  /// Returns whether the connection failed, or the peer has closed it and all received bytes were read.
  bool is_closed() const { return is_closed_; }

  /// Checks whether the connection is established by now.
  void try_connect();

  /// Reads received bytes. Returns whether there were any.
  bool read(FrameReader& input);

  /// Sends as much as there is room for.
  void write(FrameWriter& output);

  /// Returns the events that end a wait: the connection is established, bytes arrived, or there is room to send.
  native::Watch watch(bool has_output) const { return {handle_, is_connected_, !is_connected_ || has_output, false}; }

 private:
  native::Handle handle_;
  bool is_connected_ = false, is_closed_ = false;
  bool is_broken_ = false;  // nothing can be sent; received bytes can still be read
};

}  // namespace pacinian::zmtp
