#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "frame_reader.h"

/// The names of commands, and how they and their properties are read (RFC 37, "Commands" and "Connection Metadata").
namespace pacinian::zmtp::command {

constexpr std::string_view hello = "HELLO", welcome = "WELCOME", initiate = "INITIATE", ready = "READY";
constexpr std::string_view error = "ERROR", ping = "PING", pong = "PONG", subscribe = "SUBSCRIBE";

/// The largest body of a command that is accepted: a READY with all its properties is some 100 bytes.
constexpr std::size_t max_size = 4096;

using Data = std::optional<std::string_view>;

/// The data of a frame that is the command of that name; nothing if it is another frame.
Data match(const FrameReader& frame, std::string_view name);

/// The data of an ERROR. libzmq's server of PLAIN, up to 4.3.5, writes "^RROR" in place of the length 5 and "ERROR":
/// its source has "\x05ERROR", where C takes the first E for a digit of the escape.
Data match_error(const FrameReader& frame);

/// A text whose length is its first byte; nothing if it is cut off.
Data read_text(std::string_view data);

/// A property by its name, in which case does not count: "" if there is none, nothing if they are cut off.
Data find_property(std::string_view properties, std::string_view name);

/// A text of the peer's, for people: what is no printable ASCII becomes `?`.
std::string make_printable(std::string_view text);

/// Properties as bytes.
std::string write_properties(std::initializer_list<std::pair<std::string_view, std::string_view>> properties);

}  // namespace pacinian::zmtp::command
