#include "endpoint.h"

#include <algorithm>
#include <charconv>

#include "native_socket.h"

namespace pacinian::zmtp {

namespace {

constexpr std::string_view tcp = "tcp://";
constexpr std::uint8_t loopback_v4 = 127;  // the first byte
constexpr std::array<std::uint8_t, 16> loopback_v6 = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};

std::optional<std::uint16_t> read_port(std::string_view text) {
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || stop != end || port == 0) return std::nullopt;
  return port;
}

}  // namespace

bool Endpoint::is_loopback() const { return is_v6 ? address == loopback_v6 : address[0] == loopback_v4; }

std::optional<Endpoint> read_endpoint(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (text.substr(0, tcp.size()) != tcp || colon == text.npos || colon < tcp.size()) return std::nullopt;
  const auto port = read_port(text.substr(colon + 1));
  if (!port) return std::nullopt;
  std::string_view host = text.substr(tcp.size(), colon - tcp.size());
  Endpoint found;
  found.port = *port;
  found.is_v6 = host.size() > 1 && host.front() == '[' && host.back() == ']';
  if (found.is_v6)
    host = host.substr(1, host.size() - 2);
  else if (host == "localhost")
    host = "127.0.0.1";
  if (!native::read_address(std::string(host), found.is_v6, found.address)) return std::nullopt;
  return found;
}

}  // namespace pacinian::zmtp
