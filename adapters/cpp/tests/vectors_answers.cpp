// Answers lines, for a comparison with Python:
//
//     SOCKET HEX       valid HEX, as it is written again; or refused PATH
//     json HEX HEX     what a JSON object (the first) holds by a name (the second): text HEX, int N, nothing; or refused

#include <iostream>
#include <sstream>

#include "pacinian/wire/flat_json.h"
#include "vectors_files.h"

namespace {

using vectors::Bytes;

std::string text(const std::string& hex) {
  const Bytes bytes = vectors::unhex(hex);
  return {bytes.begin(), bytes.end()};
}

void json(const std::string& object, const std::string& name) {
  pacinian::wire::FlatJson read;
  std::string problem;
  const bool good = read.parse(object, problem);
  if (const std::string* found = read.text(name))
    std::cout << "text " << vectors::hex({found->begin(), found->end()}) << "\n";
  else if (const auto number = read.integer(name))
    std::cout << "int " << *number << "\n";
  else
    std::cout << (good ? "nothing" : "refused") << "\n";
}

}  // namespace

int main() {
  vectors::Sockets sockets;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string socket, first, second;
    words >> socket >> first >> second;
    Bytes made;
    if (socket == "json")
      json(text(first), text(second));
    else if (sockets.again(socket, vectors::unhex(first), made))
      std::cout << "valid " << vectors::hex(made) << "\n";
    else
      std::cout << "refused " << sockets.error.path << "\n";
  }
  return 0;
}
