// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/openigtlink/address.hpp"
#include "runtime/openigtlink/tcp_socket.hpp"
#include "runtime/openigtlink/write_message.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate::openigtlink {

/// Where and how a session is streamed.
struct StreamSettings {
    TcpAddress address{"127.0.0.1", 18944};  ///< listens here; port 0: any free one
    double rate_hz = 60;                     ///< frames per second at most
    std::size_t tool_count = 1;
    /// Also sends the force as SENSOR, for others than 3D Slicer, whose module does not know that type and
    /// logs an error for each.
    bool force_sensor = false;
};

/// What a stream has done so far.
struct StreamReport {
    std::uint64_t connected = 0;  ///< clients now
    std::uint64_t frames = 0;     ///< sent, over all clients
    std::uint64_t skipped = 0;    ///< frames that a slow client did not get
    std::uint64_t dropped = 0;    ///< clients that took nothing for two seconds
    std::uint64_t refused = 0;    ///< clients beyond most_clients
};

/// Shows a session live to 3D Slicer and others: an OpenIGTLink server that sends, whenever something new was
/// published, for each tool (names of the second tool end in 2, and so on)
///   TRANSFORM PalpateTool      the tool: translation its tip, -z along its shaft
///   TRANSFORM PalpateDevice    the same of the device, which the virtual coupling holds to the tool
///   TRANSFORM PalpateForce     an arrow at the tool: z the force on the device in N, so that a model 10 mm
///                              long along z shows 10 mm for each newton; x and y unit
///   STRING    PalpateForce     the force: "x y z N"
///   STRING    PalpateTorque    of a tool that turns by itself, about the device: "x y z N mm"
///   SENSOR    PalpateForce     the force, where StreamSettings::force_sensor
///   POINT     PalpateContacts  the contact points, each labelled with its force, "0.42 N"; without contact
///                              one point that is hidden, because 3D Slicer overlooks an empty list
/// and, on connection and whenever faults change,
///   STATUS    PalpateStatus    OK, or the first fault's code, name and cause; subcode: the Fault flags
/// Lengths in mm, RAS. Patients are not named in it, and nothing that clients send is looked at.
///
/// A thread of its own sends; what a client does not take is left out for that client by whole frames, and
/// one that takes nothing for two seconds is dropped: no client holds up others, or the caller.
class SessionStream {
  public:
    static constexpr std::size_t most_clients = 8;

    /// Listens and starts to serve. Throws InvalidInput where address or rate make no sense, SystemFailure
    /// where the port is taken.
    explicit SessionStream(const StreamSettings& settings);
    SessionStream(const SessionStream&) = delete;
    SessionStream& operator=(const SessionStream&) = delete;
    ~SessionStream();

    /// The port it listens at.
    std::uint16_t port() const noexcept { return port_; }

    /// Hands over what a tick saw of tool result.tool (others than settings.tool_count are ignored).
    /// `contact_points`: where result.active_contacts() are, in their order (p_P, mm: contact_point());
    /// missing ones are not shown. From one thread, the visual loop's or the logger's. Wait-free.
    void publish(const TickResult& result, std::span<const Eigen::Vector3d> contact_points) noexcept;

    /// Any thread.
    StreamReport report() const noexcept;

  private:
    struct Shown {
        TickResult result;
        std::array<std::array<double, 3>, max_contacts> points{};
        std::size_t point_count = 0;
        bool known = false;
    };
    struct Client {
        TcpSocket socket;
        MessageBytes unsent;  // whole messages, but for the first, of which a part may have gone
        std::chrono::steady_clock::time_point last_progress;
        std::uint32_t faults = no_fault, told_faults = no_fault;  // since the last status; in it
        bool greeted = false;
        bool behind = true;  // has not got the latest frame
    };

    void run();
    void accept_clients();
    void compose();
    void append_tool(const Shown& shown, std::size_t tool, std::uint64_t time);
    void serve(Client& client, std::uint32_t faults);
    static void drain(Client& client);
    static void flush(Client& client);

    StreamSettings settings_;
    TcpSocket listener_;
    std::uint16_t port_;
    std::vector<std::unique_ptr<realtime::TripleBuffer<Shown>>> shown_;  // one per tool
    std::atomic<std::uint32_t> faults_seen_{no_fault};                   // since the last frame

    std::vector<Client> clients_;  // these are the thread's
    MessageBytes frame_;
    bool frame_is_new_ = false;

    std::atomic<std::uint64_t> connected_{0}, frames_{0}, skipped_{0}, dropped_{0}, refused_{0};
    std::mutex mutex_;
    std::condition_variable stopped_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace palpate::openigtlink
