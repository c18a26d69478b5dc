#pragma once

#include <memory>

#include "transport.h"

namespace pacinian::client {

/// Connects with libzmq to a server on another machine, whose connection file has CURVE keys. Available if
/// PACINIAN_LIBZMQ is defined.
std::unique_ptr<Transport> connect_by_libzmq(const ConnectionFile& connection, bool all_sockets,
                                             ConnectionFailure& loss);

}  // namespace pacinian::client
