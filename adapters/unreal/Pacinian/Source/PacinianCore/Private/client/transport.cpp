#include "transport.h"

#include "libzmq_transport.h"
#include "token_transport.h"

namespace pacinian::client {

namespace {

#ifndef PACINIAN_LIBZMQ
constexpr char no_libzmq[] =
    "this server takes CURVE keys, for which this program needs libzmq, and it was built without: build it with "
    "PACINIAN_LIBZMQ (in Unreal, see Source/ThirdParty/README.md of the plugin). A server on this machine needs none "
    "if it has no keys";
#endif

}  // namespace

std::unique_ptr<Transport> connect(const ConnectionFile& connection, bool to_all, ConnectionFailure& loss) {
  if (connection.server_key.empty()) return connect_by_token(connection, to_all, loss);
#ifdef PACINIAN_LIBZMQ
  return connect_by_libzmq(connection, to_all, loss);
#else
  loss = {no_libzmq, true};
  return nullptr;
#endif
}

}  // namespace pacinian::client
