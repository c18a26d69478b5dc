#pragma once

#include <memory>

#include "transport.h"

namespace pacinian::client {

/// By the sockets of the system alone, over TCP: for a server on this machine, whose connection file has a token.
std::unique_ptr<Transport> connect_by_token(const ConnectionFile& connection, bool to_all, ConnectionFailure& loss);

}  // namespace pacinian::client
