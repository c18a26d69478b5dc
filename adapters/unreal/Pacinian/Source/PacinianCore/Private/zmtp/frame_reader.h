#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pacinian::zmtp {

/// Cuts the bytes of a peer into frames (RFC 37, "Framing"). It checks the size that a frame announces as soon as the
/// head is there. Its memory grows with the bytes that have come, never with the size that is announced.
class FrameReader {
 public:
  /// The largest bodies that it accepts, of a part of a message and of a command [bytes].
  FrameReader(std::size_t max_message, std::size_t max_command)
      : max_message_(max_message), max_command_(max_command) {}

  struct Room {
    std::uint8_t* data;
    std::size_t size;
  };

  /// Where new bytes are to be put. The size is 0 if a whole frame waits to be read.
  Room reserve();

  /// So many bytes were put where `reserve` said.
  void add(std::size_t count);

  /// Bytes that were added and not read yet.
  std::size_t waiting() const { return end_ - start_; }

  /// A byte that was added and not read yet.
  std::uint8_t peek(std::size_t index) const { return data_[start_ + index]; }

  /// Skips bytes that were looked at.
  void skip(std::size_t count) { start_ += count; }

  /// Reads the next frame. False if it has not come whole, or there is a problem.
  bool read() { return is_unread_ = read_frame(); }

  /// The frame's body, which is there until `reserve` is called.
  std::string_view body() const { return body_; }

  /// Whether another part of the same message follows.
  bool has_more() const { return has_more_; }

  bool is_command() const { return is_command_; }

  /// Why the bytes are no frames; "" while they are.
  const std::string& problem() const { return problem_; }

  /// Whether bytes have come since it was known that no whole frame is there.
  bool is_unread() const { return is_unread_; }

  /// The buffer's memory [bytes].
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
