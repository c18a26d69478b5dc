#include "frame_reader.h"

#include <algorithm>
#include <cstring>

#include "frame.h"

namespace pacinian::zmtp {

FrameReader::Room FrameReader::reserve() {
  if (start_ > 0 && (start_ == end_ || end_ == data_.size())) {
    std::memmove(data_.data(), data_.data() + start_, end_ - start_);
    end_ -= start_;
    start_ = 0;
  }
  if (end_ == data_.size() && needed_ > data_.size())
    data_.resize(std::min(needed_, 2 * data_.size()));
  return {data_.data() + end_, data_.size() - end_};
}

void FrameReader::add(std::size_t count) {
  end_ += count;
  is_unread_ = true;
}

bool FrameReader::read_frame() {
  if (!problem_.empty() || start_ == end_) return false;
  const std::uint8_t flags = data_[start_];
  is_command_ = (flags & frame::is_command) != 0;
  has_more_ = (flags & frame::more) != 0;
  if ((flags & frame::reserved) != 0 || (is_command_ && has_more_)) {
    problem_ = "a frame has the flags " + std::to_string(flags);
    return false;
  }
  const std::size_t head = (flags & frame::has_long_size) != 0 ? frame::long_head : frame::short_head;
  if (end_ - start_ < head) return false;
  const std::uint64_t size = read_size(head);
  const std::size_t limit = is_command_ ? max_command_ : max_message_;
  if (size > limit) {
    problem_ = "a frame of " + std::to_string(size) + " bytes, where at most " + std::to_string(limit) +
               " are accepted";
    return false;
  }
  needed_ = head + static_cast<std::size_t>(size);
  if (end_ - start_ < needed_) return false;
  body_ = {reinterpret_cast<const char*>(data_.data() + start_ + head), static_cast<std::size_t>(size)};
  start_ += needed_;
  needed_ = 0;
  return true;
}

std::uint64_t FrameReader::read_size(std::size_t head) const {
  std::uint64_t size = 0;
  for (std::size_t i = 1; i < head; ++i) size = size << 8 | data_[start_ + i];
  return size;
}

}  // namespace pacinian::zmtp
