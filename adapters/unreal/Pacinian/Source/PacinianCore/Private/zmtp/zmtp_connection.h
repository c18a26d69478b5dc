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

/// What is said on one connection, from the greeting to its end: handshake, messages, a subscription, heartbeats (RFC
/// 37). It is pure: bytes and times [s] are given, and it never waits. A time is to be taken before the bytes are read
/// that go with it, so that a program that stood still does not take that for the peer's silence.
class ZmtpConnection {
 public:
  /// Begins with the greeting. settings: must outlive it.
  ZmtpConnection(const Settings& settings, double now);

  /// Where the peer's bytes go.
  FrameReader& input() { return input_; }

  /// What is to be sent to the peer.
  FrameWriter& output() { return output_; }

  /// Whether messages can be sent.
  bool is_established() const { return is_established_; }

  /// How it has ended; it is to be closed then.
  Ending ending() const { return ending_; }

  /// Why it has ended, for people; "" if the peer has closed it, or it has not ended.
  const std::string& problem() const { return problem_; }

  /// Whether a message can be sent now. Once it was full there is room again when half of the frames are sent, so that
  /// what a peer does not read stays where newer messages can take its place.
  bool has_room() const {
    const std::size_t limit = is_full_ ? settings_.max_frames / 2 + 1 : settings_.max_frames;
    return is_established_ && ending_ == Ending::none && output_.frames() < limit;
  }

  /// Bytes were added to `input`, which were there at that time.
  void note_arrival(double now);

  /// The peer has closed the connection.
  void note_closed() { end(is_established_ ? Ending::gone : Ending::foreign, ""); }

  /// Goes on with the handshake; to be called when bytes have come.
  void advance();

  /// Reads the last part of the next message, also after the peer has closed the connection; false if none has come
  /// whole. Parts before it are not kept.
  bool read(std::vector<std::uint8_t>& into);

  /// Takes a message of one part; false if there is no room for it.
  bool send(std::string_view body);

  /// Sends a heartbeat that is due, and ends what was silent for too long (RFC 37, "Connection Heartbeating").
  void check_time(double now);

  /// When `check_time` is to be called at the latest.
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
  double unanswered_ = never;     // the first of our heartbeats since the peer was heard
  double peer_deadline_ = never;  // by the peer's last heartbeat, if nothing has come since
  bool is_established_ = false, is_in_message_ = false, is_wanted_ = false;
  bool is_full_ = false;     // as of the last message that was sent
  bool is_cut_off_ = false;  // what comes after a fatal command is not read
  Ending ending_ = Ending::none;
  std::string problem_;
};

}  // namespace pacinian::zmtp
