#include "stop_datagram.h"

#include <algorithm>
#include <random>
#include <vector>

#include "datagram_socket.h"
#include "sha256.h"

namespace pacinian::client {

namespace {

using StopBytes = std::vector<std::uint8_t>;

constexpr double resend_period = 0.1;  // [s] after which an unconfirmed datagram is sent again
constexpr std::size_t nonce_bytes = 16;
constexpr char hex_digits[] = "0123456789abcdef";

StopBytes make_nonce() {
  std::random_device random;
  StopBytes made(nonce_bytes);
  for (std::uint8_t& byte : made) byte = static_cast<std::uint8_t>(random());
  return made;
}

/// Returns a datagram: the nonce, and the HMAC of `what` and the nonce.
StopBytes sign_datagram(const std::string& secret, const std::string& what, const StopBytes& nonce) {
  StopBytes text(what.begin(), what.end());
  text.insert(text.end(), nonce.begin(), nonce.end());
  const Digest digest = hmac_sha256(secret, text);
  StopBytes made = nonce;
  made.insert(made.end(), digest.begin(), digest.end());
  return made;
}

std::string name_socket(const StopBytes& nonce) {
  std::string made;
  for (std::size_t i = 0; i < 4; ++i) made += {hex_digits[nonce[i] >> 4], hex_digits[nonce[i] & 15]};
  return made;
}

}  // namespace

bool request_stop(const std::string& address, const std::string& secret, double end, const std::function<double()>& clock,
                  const std::atomic<bool>& ends) {
  const StopBytes nonce = make_nonce();
  const StopBytes asked = sign_datagram(secret, "stop", nonce), confirmed = sign_datagram(secret, "stopped", nonce);
  DatagramSocket socket(address, name_socket(nonce));
  StopBytes answer(confirmed.size() + 1);
  while (socket.is_open() && !ends.load()) {
    const double left = end - clock();
    if (left <= 0.0 || !socket.send(asked.data(), asked.size())) return false;
    const std::size_t count = socket.receive(answer.data(), answer.size(), std::min(left, resend_period));
    if (count == confirmed.size() && std::equal(confirmed.begin(), confirmed.end(), answer.begin())) return true;
  }
  return false;
}

}  // namespace pacinian::client
