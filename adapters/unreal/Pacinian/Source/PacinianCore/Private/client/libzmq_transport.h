#pragma once

#include <memory>

#include "transport.h"

namespace pacinian::client {

/// By libzmq, for a server on another machine, whose connection file has CURVE keys. It is there where
/// PACINIAN_LIBZMQ is defined.
std::unique_ptr<Transport> connect_by_libzmq(const ConnectionFile& connection, bool to_all, ConnectionFailure& loss);

}  // namespace pacinian::client
