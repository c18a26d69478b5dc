#pragma once

#include <memory>

#include "transport.h"

namespace pacinian::client {

/// Connects with the system's sockets over TCP to a server on this machine, whose connection file has a token.
std::unique_ptr<Transport> connect_by_token(const ConnectionFile& connection, bool all_sockets,
                                            ConnectionFailure& loss);

}  // namespace pacinian::client
