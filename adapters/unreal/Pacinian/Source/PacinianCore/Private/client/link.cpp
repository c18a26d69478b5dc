#include "link.h"

#include <cstring>

namespace pacinian::client {

namespace {

constexpr int longest = 1 << 20;  // [bytes] of a reply or state
constexpr int denied = ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;
constexpr int foreign = ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL;
constexpr int ends = ZMQ_EVENT_CLOSED | ZMQ_EVENT_DISCONNECTED | denied | foreign;

struct Option {
  int option, value;
};

constexpr Option options[] = {
    {ZMQ_SNDHWM, 16}, {ZMQ_MAXMSGSIZE, longest},
    {ZMQ_HANDSHAKE_IVL, 2000}, {ZMQ_CONNECT_TIMEOUT, 2000},  // [ms], as all below
};
constexpr Option once[] = {{ZMQ_IMMEDIATE, 1}, {ZMQ_RECONNECT_IVL, -1}};
// No limit on what waits: libzmq 4.3 ends the process if a heartbeat is due at one.
constexpr Option beats[] = {{ZMQ_HEARTBEAT_IVL, 50},
                            {ZMQ_HEARTBEAT_TTL, 1500},
                            {ZMQ_HEARTBEAT_TIMEOUT, 1500},
                            {ZMQ_RCVHWM, 0}};

bool set_option(Socket& socket, const Option& option) {
  if (option.option != ZMQ_MAXMSGSIZE) return socket.set(option.option, option.value);
  const std::int64_t wide = option.value;
  return zmq_setsockopt(socket.get(), option.option, &wide, sizeof wide) == 0;
}

bool identify(Socket& socket, const Connection& given) {
  if (given.server_key.empty())
    return !given.token.empty() && socket.set(ZMQ_PLAIN_USERNAME, "pacinian") &&
           socket.set(ZMQ_PLAIN_PASSWORD, given.token);
  return given.server_key.size() == 40 && given.public_key.size() == 40 &&
         given.secret_key.size() == 40 && socket.set(ZMQ_CURVE_SERVERKEY, given.server_key) &&
         socket.set(ZMQ_CURVE_PUBLICKEY, given.public_key) &&
         socket.set(ZMQ_CURVE_SECRETKEY, given.secret_key);
}

}  // namespace

bool prepare(Socket& socket, const Connection& connection, const std::string& at, Loss& loss) {
  for (const Option& option : options) set_option(socket, option);
  if (!identify(socket, connection)) {
    loss = {"the connection has no token, or no keys of a client", true};
    return false;
  }
  socket.set(ZMQ_IPV6, at.find('[') != std::string::npos);
  if (socket.connect(at)) return true;
  loss = {"cannot connect to " + at + ": " + zmq_strerror(zmq_errno()), true};
  return false;
}

bool Link::open(Context& context, const Connection& connection, const std::string& at,
                bool heartbeat, Loss& loss) {
  at_ = at;
  socket_.open(context, ZMQ_DEALER);
  for (const Option& option : once) set_option(socket_, option);
  if (heartbeat)
    for (const Option& option : beats) set_option(socket_, option);
  const std::string told = "inproc://monitor-" + std::to_string(reinterpret_cast<std::uintptr_t>(this));
  zmq_socket_monitor(socket_.get(), told.c_str(), ends);
  monitor_.open(context, ZMQ_PAIR);
  return monitor_.connect(told) && prepare(socket_, connection, at, loss);
}

void Link::close() {
  if (socket_.is_open()) zmq_socket_monitor(socket_.get(), nullptr, 0);
  monitor_.close();
  socket_.close();
}

bool Link::lost(Loss& loss, bool known) {
  Message message;
  if (zmq_msg_recv(message.get(), monitor_.get(), ZMQ_DONTWAIT) < 2) return false;
  std::uint16_t event = 0;
  std::memcpy(&event, message.data(), sizeof event);
  const std::string server = "the server at " + at_ + " ";
  if (event & denied)
    loss = {server + "refuses the token or key: another server may have been started since", true};
  else if (known)
    loss = {server + "has gone", false};  // also in the middle of a handshake
  else if (event & foreign)
    loss = {server + "is no Pacinian server, wants other security (CURVE keys or a token), or is too busy", true};
  else if (event & ZMQ_EVENT_CLOSED)
    loss = {server + "does not answer: is `pacinian serve` running?", false};
  else
    loss = {server + "has gone", false};
  return true;
}

}  // namespace pacinian::client
