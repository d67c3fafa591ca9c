// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace palpate::openigtlink {

/// A TCP end: an IPv4 address or a name that resolves to one, and a port.
struct TcpAddress {
    std::string host;
    std::uint16_t port = 0;
};

/// Writes "HOST:PORT".
std::string to_string(const TcpAddress& address);

/// Where a tracked tool's pose comes from.
struct TrackerAddress {
    TcpAddress server;
    std::string tool;  ///< device name of its messages; empty: of the first pose that comes
};

/// Reads "HOST:PORT" or "HOST:PORT/NAME", as in "127.0.0.1:18944/StylusTipToReference". Throws UsageError
/// naming the text where the host is missing, the port is not 1 ... 65535 or the name is longer than the 20
/// bytes that OpenIGTLink gives it.
TrackerAddress parse_tracker_address(std::string_view text);

/// Reads "PORT" or "ADDRESS:PORT"; without an address this machine alone can connect (127.0.0.1). Throws
/// UsageError as above.
TcpAddress parse_stream_address(std::string_view text);

}  // namespace palpate::openigtlink
