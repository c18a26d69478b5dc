#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pacinian::zmtp {

/// Splits the bytes of a peer into frames (RFC 37, "Framing"). Checks a frame's size as soon as its head has arrived.
/// Memory grows with the received bytes, not with the announced size.
class FrameReader {
 public:
  /// max_message, max_command: the largest accepted bodies of a part of a message and of a command [bytes].
  FrameReader(std::size_t max_message, std::size_t max_command)
      : max_message_(max_message), max_command_(max_command) {}

  struct Room {
    std::uint8_t* data;
    std::size_t size;
  };

  /// Returns where to put new bytes. The size is 0 if a whole frame waits to be read.
  Room reserve();

  /// Adds bytes that were put where `reserve` said.
  void add(std::size_t count);

  /// Returns the number of bytes that were added and not read.
  std::size_t waiting() const { return end_ - start_; }

  /// Returns a byte that was added and not read.
  std::uint8_t peek(std::size_t index) const { return data_[start_ + index]; }

  /// Skips bytes that were peeked at.
  void skip(std::size_t count) { start_ += count; }

  /// Reads the next frame. Returns false if it has not arrived completely, or if there is a problem.
  bool read() { return is_unread_ = read_frame(); }

  /// Returns the frame's body, valid until `reserve` is called.
  std::string_view body() const { return body_; }

  /// Returns whether another part of the same message follows.
  bool has_more() const { return has_more_; }

  bool is_command() const { return is_command_; }

  /// Returns why the bytes are not frames; "" if they are.
  const std::string& problem() const { return problem_; }

  /// Returns whether bytes have arrived since the last attempt to read a frame failed.
  bool is_unread() const { return is_unread_; }

  /// Returns the size of the buffer [bytes].
  std::size_t capacity() const { return data_.size(); }

 private:
  static constexpr std::size_t first_capacity = 8192;  // [bytes]

  bool read_frame();
  std::uint64_t read_size(std::size_t head) const;

  const std::size_t max_message_, max_command_;
  std::vector<std::uint8_t> data_ = std::vector<std::uint8_t>(first_capacity);
  std::size_t start_ = 0, end_ = 0, needed_ = 0;
  std::string_view body_;
  bool has_more_ = false, is_command_ = false, is_unread_ = false;
  std::string problem_;
};

}  // namespace pacinian::zmtp
