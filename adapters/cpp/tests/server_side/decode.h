#pragma once

#include "functions.h"
#include "pacinian/wire/codec.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/reader.h"
#include "pacinian/wire/writer.h"

namespace pacinian::wire {

/// A setting.
inline bool get_scalar(Reader& in, Scalar& out, Range real, Lengths characters) {
  switch (in.next()) {
    case Kind::boolean:
      return in.get(out.emplace<bool>());
    case Kind::integer:
      return in.get(out.emplace<std::int64_t>());
    case Kind::real:
      return in.get(out.emplace<double>(), real);
    case Kind::text:
      return in.get(out.emplace<std::string>(), characters);
    default:
      return in.skip() && in.wrong("must be a bool, int, float or text");
  }
}

/// What a client has sent. False, with the reason in `error`, if the bytes are none of its messages.
template <class T>
bool decode_sent(const std::uint8_t* data, std::size_t size, T& out, WireError& error,
                 std::int64_t longest) {
  if (size > static_cast<std::size_t>(longest)) {
    error = {"is too long", "$"};
    return false;
  }
  Reader in(data, size);
  if (in.one_of(out) && in.done()) return true;
  error = in.error();
  return false;
}

inline bool decode_command(const std::uint8_t* data, std::size_t size, AnyCommand& out,
                           WireError& error) {
  return decode_sent(data, size, out, error, MAX_COMMAND_BYTES);
}

inline bool decode_control(const std::uint8_t* data, std::size_t size, AnyControl& out,
                           WireError& error) {
  return decode_sent(data, size, out, error, MAX_CONTROL_BYTES);
}

/// A message, or a variant of such, as all that is in `out`. False if it is longer than `longest`: not to be sent.
template <class T>
bool encode(const T& message, Writer& out, std::size_t longest) {
  out.clear();
  out.put(message);
  return out.size() <= longest;
}

}  // namespace pacinian::wire
