#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "ending.h"
#include "frame_reader.h"
#include "frame_writer.h"
#include "handshake.h"
#include "zmtp_settings.h"

namespace pacinian::zmtp {

/// The protocol of one connection, from the greeting to its end: handshake, messages, a subscription, heartbeats (RFC
/// 37). Never blocks, and does no input or output: bytes and times [s] are arguments. Take a time before reading the
/// bytes that belong to it. Otherwise a program that stood still takes its own pause for silence of the peer.
class ZmtpConnection {
 public:
  /// Starts with the greeting. settings: must outlive the connection.
  ZmtpConnection(const Settings& settings, double now);

  /// Returns where to put the peer's bytes.
  FrameReader& input() { return input_; }

  /// Returns the bytes to be sent to the peer.
  FrameWriter& output() { return output_; }

  /// Returns whether messages can be sent.
  bool is_established() const { return is_established_; }

  /// Returns how the connection has ended; close it then.
  Ending ending() const { return ending_; }

  /// Returns why the connection has ended, for people; "" if the peer has closed it, or if it has not ended.
  const std::string& problem() const { return problem_; }

  /// Returns whether a message can be sent now. Once the queue was full, there is room again when half of its frames
  /// are sent. Messages for a peer that does not read therefore stay where newer ones can replace them.
  bool has_room() const {
    const std::size_t limit = is_full_ ? settings_.max_frames / 2 + 1 : settings_.max_frames;
    return is_established_ && ending_ == Ending::none && output_.frames() < limit;
  }

  /// Records that bytes were added to `input` which had arrived at that time.
  void note_arrival(double now);

  /// Records that the peer has closed the connection.
  void note_closed() { end(is_established_ ? Ending::gone : Ending::foreign, ""); }

  /// Continues the handshake; call it when bytes have arrived.
  void advance();

  /// Reads the last part of the next message, even after the peer has closed the connection; drops the parts before it.
  /// Returns false if no message is complete.
  bool read(std::vector<std::uint8_t>& into);

  /// Takes a message of one part. Returns false if there is no room.
  bool send(std::string_view body);

  /// Sends a heartbeat that is due, and ends a connection that was silent for too long (RFC 37, "Connection
  /// Heartbeating").
  void check_time(double now);

  /// Returns when `check_time` must be called at the latest.
  double due() const;

 private:
  static constexpr double never = std::numeric_limits<double>::infinity();

  void subscribe();
  bool read_frame();
  bool sends_pings() const { return settings_.ping_interval > 0.0 && handshake_.minor() >= 1; }
  void handle_command();
  void answer_ping(std::string_view data);
  void end(Ending ending, std::string problem);
  void cut_off(Ending ending, std::string problem);

  const Settings& settings_;
  Handshake handshake_;
  FrameReader input_;
  FrameWriter output_;
  const std::string ping_;  // its data
  const double begun_;
  double heard_, pinged_;
  double unanswered_ = never;     // the first heartbeat sent since the peer was heard
  double peer_deadline_ = never;  // from the peer's last heartbeat, if nothing has arrived since
  bool is_established_ = false, is_in_message_ = false, is_wanted_ = false;
  bool is_full_ = false;     // as of the last message sent
  bool is_cut_off_ = false;  // bytes after a fatal command are not read
  Ending ending_ = Ending::none;
  std::string problem_;
};

}  // namespace pacinian::zmtp
