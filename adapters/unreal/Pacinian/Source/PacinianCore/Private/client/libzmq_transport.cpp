#ifdef PACINIAN_LIBZMQ

#include "libzmq_transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "libzmq_socket.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/state.h"
#include "zmtp/zmtp_settings.h"

namespace pacinian::client {

namespace {

constexpr int denied = ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;
constexpr int foreign = ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL;
constexpr int all_endings = ZMQ_EVENT_CLOSED | ZMQ_EVENT_DISCONNECTED | denied | foreign;
constexpr std::size_t key_size = 40;  // [characters] of a key in Z85
constexpr int timeout_ms = static_cast<int>(1e3 * zmtp::default_timeout);

struct Option {
  int option, value;
};

constexpr Option options_of_all[] = {
    {ZMQ_SNDHWM, 16}, {ZMQ_HANDSHAKE_IVL, timeout_ms}, {ZMQ_CONNECT_TIMEOUT, timeout_ms},  // [ms], like all below
};
constexpr Option options_of_dealers[] = {{ZMQ_IMMEDIATE, 1}, {ZMQ_RECONNECT_IVL, -1}};
// No receive limit: at a limit, libzmq 4.3 aborts the process if a heartbeat is due.
constexpr Option options_of_heartbeats[] = {
    {ZMQ_HEARTBEAT_IVL, wire::HEARTBEAT_INTERVAL_MS},
    {ZMQ_HEARTBEAT_TTL, wire::HEARTBEAT_TIMEOUT_MS},
    {ZMQ_HEARTBEAT_TIMEOUT, wire::HEARTBEAT_TIMEOUT_MS},
    {ZMQ_RCVHWM, 0},
};

template <std::size_t N>
void set_all(Socket& socket, const Option (&options)[N]) {
  for (const Option& option : options) socket.set(option.option, option.value);
}

bool set_keys(Socket& socket, const ConnectionFile& given) {
  for (const std::string* key : {&given.server_key, &given.public_key, &given.secret_key})
    if (key->size() != key_size) return false;
  return socket.set(ZMQ_CURVE_SERVERKEY, given.server_key) && socket.set(ZMQ_CURVE_PUBLICKEY, given.public_key) &&
         socket.set(ZMQ_CURVE_SECRETKEY, given.secret_key);
}

/// A socket, and whether it was full since the last wait. A monitor reports how a DEALER's connection ended.
struct Line {
  ~Line() {
    if (socket.get()) zmq_socket_monitor(socket.get(), nullptr, 0);
  }
  Socket socket, monitor;
  bool is_full = false;
};

class LibzmqTransport final : public Transport {
 public:
  bool open(const ConnectionFile& connection, bool all_sockets, ConnectionFailure& loss) {
    for (std::size_t i = 0; i < (all_sockets ? lines_.size() : 1); ++i)
      if (!open(channels[i], connection, loss)) return false;
    count_ = all_sockets ? lines_.size() : 1;
    return true;
  }

  bool send(Channel channel, const std::uint8_t* data, std::size_t size) override {
    Line& line = of(channel);
    line.is_full = !line.socket.send(data, size);
    return !line.is_full;
  }

  bool receive(Channel channel, wire::Bytes& into) override { return of(channel).socket.receive(into); }

  End ended() override {
    for (std::size_t i = 0; i < count_; ++i) {
      const Ending how = read_ending(lines_[i]);
      if (how != Ending::none) return {how, channels[i]};
    }
    return {};
  }

  void wait(double seconds, const WakeEvent* wake) override {
    std::array<zmq_pollitem_t, 2 * channels.size() + 1> items;
    int count = 0;
    const auto watch = [&](void* socket, short events) {
      if (socket) items[static_cast<std::size_t>(count++)] = {socket, 0, events, 0};
    };
    for (std::size_t i = 0; i < count_; ++i) {
      const short room = lines_[i].is_full ? ZMQ_POLLOUT : 0;
      watch(lines_[i].socket.get(), static_cast<short>(ZMQ_POLLIN | room));
      watch(lines_[i].monitor.get(), ZMQ_POLLIN);
      lines_[i].is_full = false;
    }
    if (wake && wake->handle() != zmtp::native::no_handle)
      items[static_cast<std::size_t>(count++)] = {nullptr, wake->handle(), ZMQ_POLLIN, 0};
    zmq_poll(items.data(), count, static_cast<long>(std::ceil(1e3 * std::max(0.0, seconds))));
  }

 private:
  Line& of(Channel channel) { return lines_[static_cast<std::size_t>(channel)]; }

  bool open(Channel channel, const ConnectionFile& connection, ConnectionFailure& loss) {
    const bool is_state = channel == Channel::state;
    Line& line = of(channel);
    line.socket.open(context_, is_state ? ZMQ_SUB : ZMQ_DEALER);
    set_all(line.socket, options_of_all);
    const std::int64_t max_size = wire::MAX_REPLY_BYTES;
    zmq_setsockopt(line.socket.get(), ZMQ_MAXMSGSIZE, &max_size, sizeof max_size);
    if (is_state) line.socket.set(ZMQ_SUBSCRIBE, wire::State::tag);
    if (!is_state) set_all(line.socket, options_of_dealers);
    // On other sockets, heartbeats would wait behind unread messages.
    if (channel == Channel::control) set_all(line.socket, options_of_heartbeats);
    if (!is_state && !watch_end(line, channel)) return false;
    if (!set_keys(line.socket, connection)) {
      loss = {"the connection has no token, or no keys of a client", true};
      return false;
    }
    const std::string& at = connection.at(channel);
    line.socket.set(ZMQ_IPV6, at.find('[') != std::string::npos);
    if (line.socket.connect(at)) return true;
    loss = {"cannot connect to " + at + ": " + zmq_strerror(zmq_errno()), true};
    return false;
  }

  bool watch_end(Line& line, Channel channel) {
    const std::string at = channel == Channel::control ? "inproc://control" : "inproc://command";
    zmq_socket_monitor(line.socket.get(), at.c_str(), all_endings);
    line.monitor.open(context_, ZMQ_PAIR);
    return line.monitor.connect(at);
  }

  static Ending read_ending(Line& line) {
    Message message;
    if (!line.monitor.get() || zmq_msg_recv(message.get(), line.monitor.get(), ZMQ_DONTWAIT) < 2) return Ending::none;
    std::uint16_t event = 0;
    std::memcpy(&event, message.data(), sizeof event);
    if (event & denied) return Ending::denied;
    if (event & foreign) return Ending::foreign;
    return event & ZMQ_EVENT_CLOSED ? Ending::nobody : Ending::gone;
  }

  Context context_;
  std::array<Line, channels.size()> lines_;
  std::size_t count_ = 0;
};

}  // namespace

std::unique_ptr<Transport> connect_by_libzmq(const ConnectionFile& connection, bool all_sockets,
                                             ConnectionFailure& loss) {
  auto made = std::make_unique<LibzmqTransport>();
  if (!made->open(connection, all_sockets, loss)) return nullptr;
  return made;
}

}  // namespace pacinian::client

#endif
