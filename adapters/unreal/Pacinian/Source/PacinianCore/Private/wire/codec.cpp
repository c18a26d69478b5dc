#include "pacinian/wire/codec.h"

#include <string>

#include "pacinian/wire/reader.h"

namespace pacinian::wire {

namespace {

template <class T>
bool decode(const std::uint8_t* data, std::size_t size, T& out, WireError& error,
            std::int64_t longest) {
  if (size > static_cast<std::size_t>(longest)) {
    error = {"is " + std::to_string(size) + " bytes: keep to " + std::to_string(longest), "$"};
    return false;
  }
  Reader in(data, size);
  if (in.one_of(out) && in.done()) return true;
  error = in.error();
  return false;
}

}  // namespace

bool decode_command(const std::uint8_t* data, std::size_t size, AnyCommand& out,
                    WireError& error) {
  return decode(data, size, out, error, MAX_COMMAND_BYTES);
}

bool decode_control(const std::uint8_t* data, std::size_t size, AnyControl& out,
                    WireError& error) {
  return decode(data, size, out, error, MAX_CONTROL_BYTES);
}

bool decode_reply(const std::uint8_t* data, std::size_t size, AnyReply& out, WireError& error) {
  return decode(data, size, out, error, MAX_REPLY_BYTES);
}

bool decode_state(const std::uint8_t* data, std::size_t size, AnyState& out, WireError& error) {
  return decode(data, size, out, error, MAX_REPLY_BYTES);
}

}  // namespace pacinian::wire
