#pragma once

#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "server_side/decode.h"

namespace vectors {

using pacinian::wire::Bytes;

/// A byte vector of tests/wire.
struct Vector {
  std::string name, socket, path;
  Bytes data, meant;
};

inline Bytes unhex(std::string_view text) {
  Bytes made;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    made.push_back(static_cast<std::uint8_t>(std::stoi(std::string(text.substr(i, 2)), {}, 16)));
  return made;
}

inline std::string hex(const Bytes& data) {
  std::string text;
  for (const std::uint8_t byte : data) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

/// Reads all vectors of a file with one key per line; empty if there is no such file.
inline std::vector<Vector> read(const std::string& folder, const std::string& name) {
  std::vector<Vector> made;
  std::ifstream file(folder + "/" + name + ".json");
  for (std::string line; std::getline(file, line);) {
    if (line == " {") made.emplace_back();
    const auto colon = line.find("\": \"");
    const auto end = line.rfind('"');
    if (line.substr(0, 3) != "  \"" || colon == std::string::npos) continue;
    const std::string key = line.substr(3, colon - 3);
    const std::string value = line.substr(colon + 4, end - colon - 4);
    Vector& vector = made.back();
    if (key == "name") vector.name = value;
    if (key == "socket") vector.socket = value;
    if (key == "path") vector.path = value;
    if (key == "hex") vector.data = unhex(value);
    if (key == "meant") vector.meant = unhex(value);
  }
  return made;
}

/// Returns all valid vectors.
inline std::vector<Vector> valid(const std::string& folder) {
  std::vector<Vector> all;
  for (const char* name : {"command", "control", "reply", "state", "tolerated"})
    for (Vector& vector : read(folder, name)) {
      if (vector.meant.empty()) vector.meant = vector.data;
      all.push_back(std::move(vector));
    }
  return all;
}

/// The objects into which each socket's messages are decoded, again and again.
class Sockets {
 public:
  /// Reads a message, and writes it again. Returns false and `error` if it is malformed.
  bool again(const std::string& socket, const Bytes& data, Bytes& made) {
    const std::uint8_t* bytes = data.data();
    const std::size_t size = data.size();
    if (socket == "command")
      return decode_command(bytes, size, command, error) && write(command, made);
    if (socket == "control")
      return decode_control(bytes, size, control, error) && write(control, made);
    if (socket == "reply") return decode_reply(bytes, size, reply, error) && write(reply, made);
    return decode_state(bytes, size, state, error) && write(state, made);
  }

  pacinian::wire::AnyCommand command;
  pacinian::wire::AnyControl control;
  pacinian::wire::AnyReply reply;
  pacinian::wire::AnyState state;
  pacinian::wire::WireError error;

 private:
  template <class T>
  bool write(const T& message, Bytes& made) {
    encode(message, writer_, SIZE_MAX);
    made = writer_.bytes();
    return true;
  }

  pacinian::wire::Writer writer_;
};

}  // namespace vectors
