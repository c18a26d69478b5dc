#include "handshake.h"

#include <algorithm>
#include <limits>

namespace pacinian::zmtp {

namespace {

constexpr std::size_t greeting_bytes = 64, mechanism_bytes = 20;
constexpr std::size_t signature_end = 9, version_at = 10, mechanism_at = 12;  // in the greeting
constexpr std::uint8_t signature_first = 0xff, signature_last = 0x7f, major = 3, minor_of_ours = 1;

std::string pad(std::string text, std::size_t size) {
  text.resize(size);
  return text;
}

}  // namespace

Handshake::Handshake(const Settings& settings)
    : settings_(settings), mechanism_(pad(settings.is_plain ? "PLAIN" : "NULL", mechanism_bytes)) {}

void Handshake::begin(FrameWriter& output) const {
  std::string greeting(greeting_bytes, '\0');
  greeting[0] = static_cast<char>(signature_first);
  greeting[signature_end] = static_cast<char>(signature_last);
  greeting[version_at] = static_cast<char>(major);
  greeting[version_at + 1] = static_cast<char>(minor_of_ours);
  greeting.replace(mechanism_at, mechanism_bytes, mechanism_);
  output.write_raw(greeting);
}

bool Handshake::advance(FrameReader& input, FrameWriter& output) {
  if (!problem_.empty() || is_done()) return false;
  if (step_ == Step::greeting) return read_greeting(input, output);
  if (!input.read()) {
    problem_ = input.problem();
    return false;
  }
  read_command(input, output);
  return problem_.empty();
}

bool Handshake::read_greeting(FrameReader& input, FrameWriter& output) {
  const std::size_t count = std::min(input.waiting(), greeting_bytes);
  check_greeting(input, count);
  if (!problem_.empty() || count < greeting_bytes) return false;
  const bool is_newer = input.peek(version_at) > major;
  minor_ = is_newer ? std::numeric_limits<std::uint8_t>::max() : input.peek(version_at + 1);
  input.skip(greeting_bytes);
  introduce(output);
  return true;
}

/// Checks each byte as soon as it has arrived, so that a peer without ZMTP is rejected at once.
void Handshake::check_greeting(const FrameReader& input, std::size_t count) {
  if ((count > 0 && input.peek(0) != signature_first) ||
      (count > signature_end && (input.peek(signature_end) & 1) == 0))
    problem_ = "this is not ZMTP";
  else if (count > version_at && input.peek(version_at) < major)
    problem_ = "the peer speaks ZMTP " + std::to_string(input.peek(version_at)) + ", older than 3.0";
  for (std::size_t i = 0; i < mechanism_bytes && mechanism_at + i < count && problem_.empty(); ++i)
    if (input.peek(mechanism_at + i) != static_cast<std::uint8_t>(mechanism_[i]))
      problem_ = "the peer wants another mechanism";
}

void Handshake::introduce(FrameWriter& output) {
  if (!settings_.is_plain) {
    output.write_command(command::ready, properties());
    step_ = Step::ready;
    return;
  }
  std::string data;
  for (const std::string* text : {&settings_.login.user, &settings_.login.password}) {
    data += static_cast<char>(text->size());
    data += *text;
  }
  output.write_command(command::hello, data);
  step_ = Step::welcome;
}

void Handshake::read_command(const FrameReader& input, FrameWriter& output) {
  if (const command::Data error = command::match_error(input)) return read_error(command::read_text(*error));
  const command::Data welcome = command::match(input, command::welcome), ready = command::match(input, command::ready);
  if (step_ == Step::welcome && welcome && welcome->empty()) {
    output.write_command(command::initiate, properties());
    step_ = Step::ready;
  } else if (step_ == Step::ready && ready) {
    check_type(command::find_property(*ready, "Socket-Type"));
  } else {
    problem_ = "the peer sent an unexpected frame during the handshake";
  }
}

/// Reads the reason of an ERROR. libzmq gives the status of the server's authenticator (RFC 27): 300, 400 or 500.
void Handshake::read_error(command::Data reason) {
  is_denied_ = reason == "300" || reason == "400" || reason == "500";
  problem_ = "the peer refuses: " + command::make_printable(reason.value_or("an error that cannot be read"));
}

/// Checks that the two socket types are compatible (RFC 37, "The Socket-Type Property").
void Handshake::check_type(command::Data type) {
  const bool fits = settings_.kind == Kind::sub ? type == "PUB" || type == "XPUB"
                                                : type == "ROUTER" || type == "DEALER" || type == "REP";
  if (fits)
    step_ = Step::done;
  else
    problem_ = type ? "the peer's socket is of type " + command::make_printable(*type)
                    : "the peer's properties are cut off";
}

std::string Handshake::properties() const {
  return settings_.kind == Kind::sub ? command::write_properties({{"Socket-Type", "SUB"}})
                                     : command::write_properties({{"Socket-Type", "DEALER"}, {"Identity", ""}});
}

}  // namespace pacinian::zmtp
