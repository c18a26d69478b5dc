#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "frame_reader.h"

/// Names of commands, and reading and writing of their properties (RFC 37, "Commands" and "Connection Metadata").
namespace pacinian::zmtp::command {

constexpr std::string_view hello = "HELLO", welcome = "WELCOME", initiate = "INITIATE", ready = "READY";
constexpr std::string_view error = "ERROR", ping = "PING", pong = "PONG", subscribe = "SUBSCRIBE";

/// The largest accepted body of a command; a READY with all its properties has about 100 bytes.
constexpr std::size_t max_size = 4096;

using Data = std::optional<std::string_view>;

/// Returns the data of a frame if it is the command with this name; nothing otherwise.
Data match(const FrameReader& frame, std::string_view name);

/// Returns the data of an ERROR. libzmq's PLAIN server, up to 4.3.5, writes "^RROR" instead of the length 5 and
/// "ERROR": its source has "\\x05ERROR", where C takes the first E for a digit of the escape.
Data match_error(const FrameReader& frame);

/// Reads a text whose first byte is its length; nothing if it is truncated.
Data read_text(std::string_view data);

/// Finds a property by name, ignoring case. Returns "" if there is none, nothing if the properties are truncated.
Data find_property(std::string_view properties, std::string_view name);

/// Makes a peer's text printable: replaces all but printable ASCII by `?`.
std::string make_printable(std::string_view text);

/// Encodes properties.
std::string write_properties(std::initializer_list<std::pair<std::string_view, std::string_view>> properties);

}  // namespace pacinian::zmtp::command
