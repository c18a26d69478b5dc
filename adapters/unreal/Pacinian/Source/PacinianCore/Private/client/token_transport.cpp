#include "token_transport.h"

#include <algorithm>
#include <array>
#include <optional>

#include "pacinian/client/options.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/state.h"
#include "zmtp/zmtp_socket.h"

namespace pacinian::client {

namespace {

constexpr char user[] = "pacinian";

zmtp::Settings make_settings(Channel channel, const std::string& token) {
  zmtp::Settings made;
  made.kind = channel == Channel::state ? zmtp::Kind::sub : zmtp::Kind::dealer;
  made.is_plain = true;
  made.login = {user, token};
  made.topic = wire::State::tag;
  made.max_message = static_cast<std::size_t>(wire::MAX_REPLY_BYTES);
  // On other sockets, heartbeats would wait behind unread messages.
  if (channel == Channel::control) made.ping_interval = 1e-3 * wire::HEARTBEAT_INTERVAL_MS;
  made.ping_timeout = 1e-3 * wire::HEARTBEAT_TIMEOUT_MS;
  return made;
}

class TokenTransport final : public Transport {
 public:
  bool open(const ConnectionFile& connection, bool all_sockets, ConnectionFailure& loss) {
    const std::size_t size = connection.token.size();
    if (size == 0 || size > zmtp::Login::max_size) {
      loss = {"the connection has no token, or no keys of a client", true};
      return false;
    }
    for (std::size_t i = 0; i < (all_sockets ? sockets_.size() : 1); ++i) {
      const Channel channel = channels[i];
      const auto at = zmtp::read_endpoint(connection.at(channel));
      if (!at || !at->is_loopback()) {  // a token is sent in clear text
        loss = {"cannot connect to " + connection.at(channel) +
                    ": with a token it must be tcp://ADDRESS:PORT of this machine",
                true};
        return false;
      }
      sockets_[i].emplace(make_settings(channel, connection.token), *at, channel == Channel::state, steady_clock);
    }
    return true;
  }

  bool send(Channel channel, const std::uint8_t* data, std::size_t size) override {
    auto& socket = of(channel);
    return socket && socket->send({reinterpret_cast<const char*>(data), size});
  }

  bool receive(Channel channel, wire::Bytes& into) override {
    auto& socket = of(channel);
    return socket && socket->receive(into);
  }

  End ended() override {
    for (std::size_t i = 0; i < sockets_.size(); ++i)
      if (sockets_[i] && sockets_[i]->ended() != Ending::none) return {sockets_[i]->ended(), channels[i]};
    return {};
  }

  void wait(double seconds, const WakeEvent* wake) override {
    std::array<zmtp::native::Watch, channels.size() + 1> watches;
    if (wake) watches.back() = {wake->handle(), true, false, false};
    const double now = steady_clock();
    for (std::size_t i = 0; i < sockets_.size(); ++i) {
      if (!sockets_[i]) continue;
      watches[i] = sockets_[i]->watch();
      seconds = std::min(seconds, sockets_[i]->due() - now);
    }
    zmtp::native::wait(watches.data(), watches.size(), seconds);
    for (auto& socket : sockets_)
      if (socket) socket->work();
  }

 private:
  std::optional<zmtp::ZmtpSocket>& of(Channel channel) { return sockets_[static_cast<std::size_t>(channel)]; }

  std::array<std::optional<zmtp::ZmtpSocket>, channels.size()> sockets_;
};

}  // namespace

std::unique_ptr<Transport> connect_by_token(const ConnectionFile& connection, bool all_sockets,
                                            ConnectionFailure& loss) {
  auto made = std::make_unique<TokenTransport>();
  if (!made->open(connection, all_sockets, loss)) return nullptr;
  return made;
}

}  // namespace pacinian::client
