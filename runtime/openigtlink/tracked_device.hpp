// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "runtime/openigtlink/address.hpp"
#include "runtime/openigtlink/read_message.hpp"
#include "runtime/openigtlink/tcp_socket.hpp"
#include "runtime/realtime/device.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate::openigtlink {

/// How long a tracked device waits.
struct TrackerPatience {
    std::chrono::milliseconds first_pose{5000};  ///< on construction
    std::chrono::milliseconds pose{100};         ///< since the last pose, before it is device_lost
};

/// What a tracked device has received so far.
struct TrackerReport {
    bool connected = false;
    std::uint64_t poses = 0;       ///< of its tool, used
    std::uint64_t refused = 0;     ///< of its tool, not a pose: the last one's reason is last_problem
    std::uint64_t crc_errors = 0;  ///< dropped: what came is not what was sent
    std::uint64_t reconnections = 0;
    std::string last_problem;  ///< of connection or pose; empty: none so far
};

/// A tracker's or 3D Slicer's tool as a device without force. Connects to an OpenIGTLink server, follows the
/// TRANSFORM, POSITION or QTRANS messages of one device name (header versions 1 to 3) and connects again half
/// a second after a loss. The message's frame, RAS, becomes LPS: D is what the server calls the pose's
/// parent, so D = P where it sends the tool in the patient's frame. The position is the translation, the
/// shaft lies along -z of the rotation: read_pose().
///
/// Faults: device_lost where no pose came for TrackerPatience::pose or the connection is gone;
/// invalid_position from a pose that read_pose() refuses, or a STATUS of the same name other than OK, until
/// the next good pose. The last good position stays in the state. Messages with a wrong CRC count as not
/// come. A message's size never decides how much memory is used.
class TrackedDevice final : public realtime::Device {
  public:
    /// Returns when the first pose has come. Throws InvalidInput naming host, port and what was heard if the
    /// host is unknown or no pose comes in time.
    explicit TrackedDevice(const TrackerAddress& address, TrackerPatience patience = {});
    TrackedDevice(const TrackedDevice&) = delete;
    TrackedDevice& operator=(const TrackedDevice&) = delete;
    ~TrackedDevice() override;  ///< takes one second at most

    std::string name() const override;
    DeviceLimits limits() const override { return {}; }
    /// Wait-free.
    realtime::DeviceState read(double time) noexcept override;
    void write(const realtime::Wrench&) noexcept override {}

    /// Not from the servo's thread: it locks.
    TrackerReport report() const;

  private:
    struct Latest {
        std::array<double, 3> position{0, 0, 0}, shaft{0, 0, 0};
        std::array<double, 4> orientation{0, 0, 0, 0};
        std::int64_t received_ns = 0;  // 0: never
        std::uint32_t faults = device_lost;
    };
    enum class Receipt { whole, ended };

    void stop();
    void run();
    void follow(TcpSocket& socket);
    Receipt receive(TcpSocket& socket, std::span<std::byte> bytes, bool message_has_begun);
    Receipt skip(TcpSocket& socket, std::uint64_t size);
    void take(const MessageHead& head, std::span<const std::byte> body);
    void take_pose(const MessageHead& head, std::span<const std::byte> body);
    void take_status(const MessageHead& head, std::span<const std::byte> body);
    void publish(std::uint32_t faults);
    void note(const std::string& problem);
    bool wait_for_stop(std::chrono::milliseconds patience);
    std::string what_was_heard() const;  // the mutex is held

    TrackerAddress address_;
    TrackerPatience patience_;
    ResolvedAddress server_;
    realtime::TripleBuffer<Latest> latest_;
    Latest pose_;                  // the receiver's
    std::vector<std::byte> body_;  // the receiver's, of fixed size

    mutable std::mutex mutex_;  // of what follows
    std::condition_variable changed_;
    TrackerReport report_;
    std::string followed_;                        // the device name; empty until the first pose
    std::map<std::string, std::uint64_t> heard_;  // "IMAGE messages 'Reference'" and how many
    bool ever_connected_ = false;
    std::atomic<bool> stop_{false};

    std::thread receiver_;
};

}  // namespace palpate::openigtlink
