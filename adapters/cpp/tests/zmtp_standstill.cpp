// A program that stood still while it connected, for longer than the connect timeout, must still connect.

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <vector>

#include "expect.h"
#include "zmtp/zmtp_socket.h"

namespace {

using namespace pacinian::zmtp;

constexpr int waiting = 8;  // more connections than the listener's queue has room for, so that the next one must wait

constexpr int max_looks = 6000;

double now = 0.0;  // [s]

sockaddr_in listen(int listener) {
  sockaddr_in at = {};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  EXPECT(::bind(listener, reinterpret_cast<sockaddr*>(&at), size) == 0 && ::listen(listener, 1) == 0);
  ::getsockname(listener, reinterpret_cast<sockaddr*>(&at), &size);
  return at;
}

int begin_to_connect(const sockaddr_in& at) {
  const int made = ::socket(AF_INET, SOCK_STREAM, 0);
  ::fcntl(made, F_SETFL, O_NONBLOCK);
  ::connect(made, reinterpret_cast<const sockaddr*>(&at), sizeof at);
  return made;
}

}  // namespace

int main() {
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  const sockaddr_in at = listen(listener);
  std::vector<int> opened = {listener};
  for (int i = 0; i < waiting; ++i) opened.push_back(begin_to_connect(at));
  const auto endpoint = read_endpoint("tcp://127.0.0.1:" + std::to_string(ntohs(at.sin_port)));
  ZmtpSocket socket(Settings(), *endpoint, false, [] { return now; });
  EXPECT(socket.watch().writes && !socket.watch().reads && socket.due() == 2.0);  // not connected yet
  ::fcntl(listener, F_SETFL, O_NONBLOCK);
  native::Watch watch = socket.watch();
  for (int i = 0; i < max_looks && !watch.is_ready; ++i) {  // until the system has connected it
    opened.push_back(::accept(listener, nullptr, nullptr));
    native::wait(&watch, 1, 0.01);
  }
  now = 1000.0;
  socket.work();
  EXPECT(socket.ended() == Ending::none && socket.watch().reads);
  for (const int each : opened) ::close(each);
  return check::result();
}
