#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace pacinian::client {

/// Sends an emergency stop to a server on this machine as a datagram. It needs no connection, so other clients cannot
/// block it. An HMAC in both datagrams proves that the sender has the secret of the connection file. Returns whether the
/// server has confirmed the stop.
/// address: `stop` of the connection file. secret: its token, or its secret key. end: by the clock [s]. ends: set to end
/// sooner.
bool request_stop(const std::string& address, const std::string& secret, double end, const std::function<double()>& clock,
                  const std::atomic<bool>& ends);

}  // namespace pacinian::client
