#include "frame_writer.h"

#include <algorithm>

#include "frame.h"

namespace pacinian::zmtp {

void FrameWriter::mark_sent(std::size_t count) {
  start_ += count;
  sent_ += count;
  ends_.erase(ends_.begin(), std::upper_bound(ends_.begin(), ends_.end(), sent_));
}

void FrameWriter::write_message(std::string_view body) {
  write_head(0, body.size());
  put(body);
  end_frame();
}

void FrameWriter::write_command(std::string_view name, std::string_view data) {
  write_head(frame::is_command, 1 + name.size() + data.size());
  data_.push_back(static_cast<std::uint8_t>(name.size()));
  put(name);
  put(data);
  end_frame();
}

void FrameWriter::write_head(std::uint8_t flags, std::size_t size) {
  data_.erase(data_.begin(), data_.begin() + static_cast<std::ptrdiff_t>(start_));
  start_ = 0;
  if (size <= frame::max_short_size) {
    data_.push_back(flags);
    data_.push_back(static_cast<std::uint8_t>(size));
    return;
  }
  data_.push_back(static_cast<std::uint8_t>(flags | frame::has_long_size));
  for (int shift = 56; shift >= 0; shift -= 8)
    data_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(size) >> shift));
}

}  // namespace pacinian::zmtp
