// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <future>
#include <igtlClientSocket.h>
#include <igtlMessageBase.h>
#include <igtlServerSocket.h>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "runtime/openigtlink/tracked_device.hpp"

namespace palpate {

/// Longer than anything here takes on a busy machine; a test that waits so long has failed.
inline constexpr std::chrono::milliseconds long_enough{10'000};

/// Asks again and again until `holds()`, for at most long_enough.
template <typename Predicate>
bool eventually(const Predicate& holds) {
    const auto end = std::chrono::steady_clock::now() + long_enough;
    while (!holds()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
}

using Bytes = std::vector<std::byte>;

/// A 4 x 4 matrix by rows, RAS.
using Rows = std::array<std::array<float, 4>, 4>;

/// Messages as the library packs them.
Bytes transform_message(const std::string& device, const Rows& matrix);
Bytes position_message(const std::string& device, const std::array<float, 3>& position,
                       const std::array<float, 4>& quaternion);
Bytes status_message(const std::string& device, int code);
/// A message of any type with a right head and CRC around `body`.
Bytes message(const std::string& type, const std::string& device, const Bytes& body, int version = 1);

/// A tracker: the library's server on a free port of this machine.
class TrackerPeer {
  public:
    TrackerPeer();
    openigtlink::TrackerAddress address(const std::string& tool) const;
    /// Waits for the next connection; false if none comes.
    bool accept();
    void send(std::span<const std::byte> bytes);
    void close_connection();
    /// A device that has just received `first`.
    std::unique_ptr<openigtlink::TrackedDevice> device(const std::string& tool, const Bytes& first,
                                                       std::chrono::milliseconds pose_patience = long_enough);

  private:
    igtl::ServerSocket::Pointer server_;
    igtl::ClientSocket::Pointer connection_;
};

/// A message that came, unpacked but for its body.
struct Received {
    std::string type, device;
    igtl::MessageHeader::Pointer head;
    Bytes body;

    /// The body as the library's own class reads it, its CRC checked; null if it does not fit.
    template <typename Message>
    typename Message::Pointer as() const {
        auto out = Message::New();
        out->SetMessageHeader(head);
        out->AllocatePack();
        if (static_cast<std::size_t>(out->GetPackBodySize()) != body.size()) return nullptr;
        std::copy(body.begin(), body.end(), static_cast<std::byte*>(out->GetPackBodyPointer()));
        return out->Unpack(1) & igtl::MessageHeader::UNPACK_BODY ? out : nullptr;
    }
};

/// One who watches: the library's client.
class WatchingPeer {
  public:
    explicit WatchingPeer(int port);
    bool connected() const { return connected_; }
    /// The next message; type empty if none comes or the connection is closed.
    Received next();
    /// The next message of this type and device name.
    Received next(const std::string& type, const std::string& device);
    void send(std::span<const std::byte> bytes);
    void close() { socket_->CloseSocket(); }

  private:
    igtl::ClientSocket::Pointer socket_;
    bool connected_;
};

}  // namespace palpate
