#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace pacinian::zmtp {

/// The encoded frames that wait to be sent (RFC 37, "Framing").
class FrameWriter {
 public:
  /// Returns the waiting bytes.
  const std::uint8_t* data() const { return data_.data() + start_; }
  std::size_t size() const { return data_.size() - start_; }

  /// Returns the number of waiting frames, including a frame that is partly sent.
  std::size_t frames() const { return ends_.size(); }

  /// Removes bytes that were sent.
  void mark_sent(std::size_t count);

  /// Writes bytes that are not a frame.
  void write_raw(std::string_view bytes) { put(bytes); }

  /// Writes a message of one part.
  void write_message(std::string_view body);

  /// Writes a command: its name, then its data (RFC 37, "Formal Grammar").
  void write_command(std::string_view name, std::string_view data);

 private:
  void write_head(std::uint8_t flags, std::size_t size);
  void end_frame() { ends_.push_back(sent_ + size()); }
  void put(std::string_view bytes) { data_.insert(data_.end(), bytes.begin(), bytes.end()); }

  std::vector<std::uint8_t> data_;
  std::size_t start_ = 0;
  std::vector<std::uint64_t> ends_;  // of the frames, counted from the first byte ever written
  std::uint64_t sent_ = 0;
};

}  // namespace pacinian::zmtp
