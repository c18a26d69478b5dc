#include "pacinian/wire/codec.h"

#include <string>

#include "pacinian/wire/reader.h"

namespace pacinian::wire {

namespace {

template <class T>
bool decode(const std::uint8_t* data, std::size_t size, T& out, WireError& error) {
  if (size > static_cast<std::size_t>(MAX_REPLY_BYTES)) {
    error = {"is " + std::to_string(size) + " bytes: keep to " + std::to_string(MAX_REPLY_BYTES), "$"};
    return false;
  }
  Reader in(data, size);
  if (in.one_of(out) && in.done()) return true;
  error = in.error();
  return false;
}

}  // namespace

bool decode_reply(const std::uint8_t* data, std::size_t size, AnyReply& out, WireError& error) {
  return decode(data, size, out, error);
}

bool decode_state(const std::uint8_t* data, std::size_t size, AnyState& out, WireError& error) {
  return decode(data, size, out, error);
}

}  // namespace pacinian::wire
