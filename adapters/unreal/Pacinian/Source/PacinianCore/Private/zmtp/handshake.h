#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "command.h"
#include "frame_reader.h"
#include "frame_writer.h"
#include "zmtp_settings.h"

namespace pacinian::zmtp {

/// The client's side of the greeting and of the mechanisms NULL and PLAIN, until the peer is ready (RFC 37, "Formal
/// Grammar", "The NULL Security Mechanism"; RFC 24, "Implementation"). Rejects peers older than ZMTP 3.0.
class Handshake {
 public:
  explicit Handshake(const Settings& settings);

  /// Writes the greeting.
  void begin(FrameWriter& output) const;

  /// Handles received bytes. Returns whether the handshake advanced.
  bool advance(FrameReader& input, FrameWriter& output);

  /// Returns whether the peer is ready.
  bool is_done() const { return step_ == Step::done; }

  /// Returns why there will be no connection; "" if there may be.
  const std::string& problem() const { return problem_; }

  /// Returns whether the peer rejected the name and password.
  bool is_denied() const { return is_denied_; }

  /// Returns the minor number of the peer's version, which is 3.0 or newer.
  std::uint8_t minor() const { return minor_; }

 private:
  enum class Step : std::uint8_t { greeting, welcome, ready, done };

  bool read_greeting(FrameReader& input, FrameWriter& output);
  void check_greeting(const FrameReader& input, std::size_t count);
  void introduce(FrameWriter& output);
  void read_command(const FrameReader& input, FrameWriter& output);
  void read_error(command::Data reason);
  void check_type(command::Data type);
  std::string properties() const;

  const Settings& settings_;
  const std::string mechanism_;
  Step step_ = Step::greeting;
  std::uint8_t minor_ = 0;
  bool is_denied_ = false;
  std::string problem_;
};

}  // namespace pacinian::zmtp
