// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "runtime/openigtlink/address.hpp"

namespace palpate::openigtlink {

/// One end of a TCP connection, or a listening end; closed where it ends. Nothing here waits longer than it
/// is told to or raises a signal. One thread at a time.
class TcpSocket {
  public:
    TcpSocket() = default;
    explicit TcpSocket(int descriptor) : descriptor_(descriptor) {}
    TcpSocket(TcpSocket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    TcpSocket& operator=(TcpSocket&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~TcpSocket();

    bool is_open() const noexcept { return descriptor_ >= 0; }
    int descriptor() const noexcept { return descriptor_; }

    /// Receives what is there, at most `bytes`, and returns how much; waits for at most `patience`, and
    /// returns 0 where nothing came. nullopt: the other end has closed, or the connection is broken.
    std::optional<std::size_t> receive(std::span<std::byte> bytes, std::chrono::milliseconds patience);
    /// Sends as much of `bytes` as the system takes at once and returns how much. nullopt as above.
    std::optional<std::size_t> send(std::span<const std::byte> bytes);

  private:
    int descriptor_ = -1;
};

/// An address that has been looked up.
struct ResolvedAddress {
    std::uint32_t ipv4 = 0;  ///< in network byte order
    std::uint16_t port = 0;
};

/// Looks a host up; takes as long as the system's resolver. Throws InvalidInput naming host and cause.
ResolvedAddress resolve(const TcpAddress& address);

/// Connects within `patience`; otherwise the socket is closed and `problem` says why. A connection whose
/// other end has vanished without a word breaks within about 4 s.
TcpSocket connect_to(const ResolvedAddress& address, std::chrono::milliseconds patience,
                     std::string& problem);

/// Listens at an address of this machine; port 0: any free one. Throws InvalidInput where the address is not
/// this machine's, SystemFailure where the port is taken or not permitted.
TcpSocket listen_at(const TcpAddress& address);
/// The port that a listening socket has.
std::uint16_t port_of(const TcpSocket& listener);
/// The next one who has connected, without waiting; closed if there is none. No more than about 64 KiB wait
/// in the system to be sent to it, so that what it gets is not old.
TcpSocket accept_from(const TcpSocket& listener);

}  // namespace palpate::openigtlink
