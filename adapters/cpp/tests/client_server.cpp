// A game that starts the server, executes commands from standard input, and prints the server's state.
// Arguments: connection file, log of the server, program, more arguments of the server.

#include <poll.h>
#include <unistd.h>

#include "client_driver.h"
#include "pacinian/client.h"
#include "pacinian/server_process.h"

int main(int count, char** arguments) {
  if (count < 4) return 2;
  pacinian::ServerProcess::Options serve;
  pacinian::Options connect;
  serve.connection_path = connect.connection_path = arguments[1];
  serve.log = arguments[2];
  serve.program = arguments[3];
  serve.arguments.assign(arguments + 4, arguments + count);
  pacinian::ServerProcess server(serve);
  pacinian::Client client(connect);
  client.start();
  server.start();
  for (std::string said;;) {
    pollfd input = {STDIN_FILENO, POLLIN, 0};
    char letter = 0;
    if (::poll(&input, 1, 10) > 0 && ::read(STDIN_FILENO, &letter, 1) <= 0) return 0;
    const bool connected = client.status() == pacinian::Status::connected;
    client.tick();
    server.tick(connected);
    if (letter != '\n') {
      if (letter) said += letter;
      continue;
    }
    if (said == "end") return 0;
    if (said == "stop") server.stop();
    if (said == "status") driver::say({{"status", connected}, {"runs", server.runs()}, {"problem", server.problem()}});
    said.clear();
  }
}
