#include "transport.h"

#include "libzmq_transport.h"
#include "token_transport.h"

namespace pacinian::client {

namespace {

#ifndef PACINIAN_LIBZMQ
constexpr char no_libzmq[] =
    "this server requires CURVE keys, so this program needs libzmq, but it was built without libzmq: build it with "
    "PACINIAN_LIBZMQ (in Unreal, see Source/ThirdParty/README.md of the plugin). A server on this machine that uses a "
    "token needs no libzmq";
#endif

}  // namespace

std::unique_ptr<Transport> connect(const ConnectionFile& connection, bool all_sockets, ConnectionFailure& loss) {
  if (connection.server_key.empty()) return connect_by_token(connection, all_sockets, loss);
#ifdef PACINIAN_LIBZMQ
  return connect_by_libzmq(connection, all_sockets, loss);
#else
  loss = {no_libzmq, true};
  return nullptr;
#endif
}

}  // namespace pacinian::client
