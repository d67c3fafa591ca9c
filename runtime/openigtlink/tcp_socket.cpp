// SPDX-License-Identifier: Apache-2.0
#include "runtime/openigtlink/tcp_socket.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <fcntl.h>
#include <memory>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate::openigtlink {
namespace {

std::string text_of(int error) {
    return std::generic_category().message(error);
}

void set_option(const TcpSocket& socket, int level, int option, int value) {
    ::setsockopt(socket.descriptor(), level, option, &value, sizeof(value));
}

sockaddr_in system_address(const ResolvedAddress& address) {
    sockaddr_in out{};
    out.sin_family = AF_INET;
    out.sin_addr.s_addr = address.ipv4;
    out.sin_port = htons(address.port);
    return out;
}

// Tells whether `events` come within `patience`; a signal may cut the wait short.
bool wait_for(const TcpSocket& socket, short events, std::chrono::milliseconds patience) {
    pollfd watched{socket.descriptor(), events, 0};
    return ::poll(&watched, 1, static_cast<int>(patience.count())) > 0;
}

bool would_wait(int error) {
    return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

TcpSocket open_socket() {
    return TcpSocket(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

// Connects within `patience` and returns 0, or the system's error.
int connect_within(const TcpSocket& socket, const sockaddr_in& peer, std::chrono::milliseconds patience) {
    if (!socket.is_open()) return errno;
    set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
    set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, 1);
    set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, 1);
    set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, 3);
    if (::connect(socket.descriptor(), reinterpret_cast<const sockaddr*>(&peer), sizeof(peer)) == 0) return 0;
    if (errno != EINPROGRESS) return errno;
    if (!wait_for(socket, POLLOUT, patience)) return ETIMEDOUT;
    int error = 0;
    socklen_t size = sizeof(error);
    ::getsockopt(socket.descriptor(), SOL_SOCKET, SO_ERROR, &error, &size);
    return error;
}

}  // namespace

TcpSocket::~TcpSocket() {
    if (is_open()) ::close(descriptor_);
}

std::optional<std::size_t> TcpSocket::receive(std::span<std::byte> bytes,
                                              std::chrono::milliseconds patience) {
    if (!wait_for(*this, POLLIN, patience)) return 0;
    const ssize_t count = ::recv(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && would_wait(errno)) return 0;
    return std::nullopt;
}

std::optional<std::size_t> TcpSocket::send(std::span<const std::byte> bytes) {
    const ssize_t count = ::send(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (would_wait(errno)) return 0;
    return std::nullopt;
}

ResolvedAddress resolve(const TcpAddress& address) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    const int error = ::getaddrinfo(address.host.c_str(), nullptr, &hints, &found);
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, ::freeaddrinfo);
    if (error != 0)
        throw InvalidInput({to_string(address),
                            "host '" + address.host + "' was not found: " + ::gai_strerror(error),
                            "a host's name or IPv4 address", "check its spelling and the network"});
    return {reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr.s_addr, address.port};
}

TcpSocket connect_to(const ResolvedAddress& address, std::chrono::milliseconds patience,
                     std::string& problem) {
    TcpSocket socket = open_socket();
    const int error = connect_within(socket, system_address(address), patience);
    if (error == 0) return socket;
    problem = text_of(error);
    return {};
}

TcpSocket listen_at(const TcpAddress& address) {
    const sockaddr_in here = system_address(resolve(address));
    TcpSocket socket = open_socket();
    if (!socket.is_open())
        throw SystemFailure(
            {to_string(address), text_of(errno), "", "close other programs, or raise 'ulimit -n'"});
    set_option(socket, SOL_SOCKET, SO_REUSEADDR, 1);
    if (::bind(socket.descriptor(), reinterpret_cast<const sockaddr*>(&here), sizeof(here)) != 0) {
        if (errno == EADDRNOTAVAIL)
            throw InvalidInput({to_string(address),
                                "'" + address.host + "' is not an address of this machine", "",
                                "write 127.0.0.1 for this machine alone or 0.0.0.0 for all its networks"});
        throw SystemFailure({to_string(address), text_of(errno), "a free port",
                             "choose another port, or end the program that has it"});
    }
    if (::listen(socket.descriptor(), SOMAXCONN) != 0)
        throw SystemFailure({to_string(address), text_of(errno), "a free port", "choose another port"});
    return socket;
}

std::uint16_t port_of(const TcpSocket& listener) {
    sockaddr_in here{};
    socklen_t size = sizeof(here);
    ::getsockname(listener.descriptor(), reinterpret_cast<sockaddr*>(&here), &size);
    return ntohs(here.sin_port);
}

TcpSocket accept_from(const TcpSocket& listener) {
    TcpSocket socket(::accept4(listener.descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.is_open()) return socket;
    set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(socket, SOL_SOCKET, SO_SNDBUF, 32 * 1024);  // Linux doubles it
    return socket;
}

}  // namespace palpate::openigtlink
