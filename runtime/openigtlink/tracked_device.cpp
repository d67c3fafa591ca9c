// SPDX-License-Identifier: Apache-2.0
#include "runtime/openigtlink/tracked_device.hpp"

#include <algorithm>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"

namespace palpate::openigtlink {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds connect_patience{900};
constexpr milliseconds pause_before_reconnecting{500};
constexpr milliseconds slice{50};               // after which a stop is noticed
constexpr milliseconds message_patience{2000};  // for the rest of a message that has begun
constexpr std::size_t body_room = 65'536;       // bytes; larger bodies carry no pose
constexpr std::size_t most_heard = 16;          // kinds of messages remembered

std::int64_t now_ns() noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

TrackedDevice::TrackedDevice(const TrackerAddress& address, TrackerPatience patience)
    : address_(address),
      patience_(patience),
      server_(resolve(address.server)),
      body_(body_room),
      followed_(address.tool),
      receiver_([this] { run(); }) {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, patience_.first_pose, [this] { return report_.poses > 0; })) return;
    const ErrorDetail detail{to_string(address_.server), what_was_heard(),
                             "TRANSFORM messages" + (address_.tool.empty() ? "" : " '" + address_.tool + "'"),
                             "start the server, let it send the tool's transform, and name that transform"};
    lock.unlock();
    stop();
    throw InvalidInput(detail);
}

TrackedDevice::~TrackedDevice() {
    stop();
}

void TrackedDevice::stop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    receiver_.join();
}

std::string TrackedDevice::name() const {
    const std::lock_guard lock(mutex_);
    return "tracked tool '" + followed_ + "' from " + to_string(address_.server) + ", without force";
}

realtime::DeviceState TrackedDevice::read(double time) noexcept {
    const Latest& latest = latest_.read();
    realtime::DeviceState state;
    state.time = time;
    state.position = latest.position;
    state.shaft = latest.shaft;
    state.orientation = latest.orientation;
    state.faults = latest.faults;
    if (now_ns() - latest.received_ns > std::chrono::nanoseconds(patience_.pose).count())
        state.faults |= device_lost;
    return state;
}

TrackerReport TrackedDevice::report() const {
    const std::lock_guard lock(mutex_);
    return report_;
}

void TrackedDevice::run() {
    do {
        std::string problem;
        TcpSocket socket = connect_to(server_, connect_patience, problem);
        if (!socket.is_open()) {
            note("no connection: " + problem);
            continue;
        }
        {
            const std::lock_guard lock(mutex_);
            report_.connected = true;
            report_.reconnections += ever_connected_ ? 1 : 0;
            ever_connected_ = true;
        }
        follow(socket);
        publish(device_lost);
        const std::lock_guard lock(mutex_);
        report_.connected = false;
    } while (!wait_for_stop(pause_before_reconnecting));
}

// Reads messages until the connection ends, what comes is not OpenIGTLink, or stop.
void TrackedDevice::follow(TcpSocket& socket) {
    std::array<std::byte, MessageHead::size> head_bytes;
    while (receive(socket, head_bytes, false) == Receipt::whole) {
        const auto head = read_head(head_bytes);
        if (!head) return note("what came is not OpenIGTLink");
        if (head->body_size > body_.size()) {
            take(*head, {});
            if (skip(socket, head->body_size) == Receipt::ended) return;
            continue;
        }
        const std::span body(body_.data(), static_cast<std::size_t>(head->body_size));
        if (receive(socket, body, true) == Receipt::ended) return;
        take(*head, body);
    }
}

TrackedDevice::Receipt TrackedDevice::receive(TcpSocket& socket, std::span<std::byte> bytes,
                                              bool message_has_begun) {
    auto last_progress = steady_clock::now();
    while (!bytes.empty()) {
        if (stop_) return Receipt::ended;
        const auto count = socket.receive(bytes, slice);
        if (!count) {
            note("the server closed the connection");
            return Receipt::ended;
        }
        if (*count > 0) {
            bytes = bytes.subspan(*count);
            message_has_begun = true;
            last_progress = steady_clock::now();
        } else if (message_has_begun && steady_clock::now() - last_progress > message_patience) {
            note("the server stopped within a message");
            return Receipt::ended;
        }
    }
    return Receipt::whole;
}

TrackedDevice::Receipt TrackedDevice::skip(TcpSocket& socket, std::uint64_t size) {
    while (size > 0) {
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(size, body_.size()));
        if (receive(socket, {body_.data(), count}, true) == Receipt::ended) return Receipt::ended;
        size -= count;
    }
    return Receipt::whole;
}

// A body that does not fit comes as an empty one.
void TrackedDevice::take(const MessageHead& head, std::span<const std::byte> body) {
    {
        const std::lock_guard lock(mutex_);
        const std::string kind = head.type + " messages '" + head.device + "'";
        if (heard_.contains(kind) || heard_.size() < most_heard) ++heard_[kind];
        if (!followed_.empty() && head.device != followed_) return;
    }
    const bool pose = carries_pose(head);
    if (!pose && head.type != "STATUS") return;
    if (body.size() == head.body_size && !crc_fits(head, body)) {
        const std::lock_guard lock(mutex_);
        ++report_.crc_errors;
        report_.last_problem = "a message of '" + head.device + "' with a wrong CRC";
        return;
    }
    pose ? take_pose(head, body) : take_status(head, body);
}

void TrackedDevice::take_pose(const MessageHead& head, std::span<const std::byte> body) {
    const PoseReading reading = read_pose(head, body);
    if (!reading.pose) {
        publish(invalid_position);
        note("pose of '" + head.device + "': " + reading.problem);
        const std::lock_guard lock(mutex_);
        ++report_.refused;
        return;
    }
    pose_.position = array_of(reading.pose->tip);
    pose_.shaft = array_of(reading.pose->shaft);
    pose_.orientation = array_of(reading.pose->orientation);
    publish(no_fault);
    {
        const std::lock_guard lock(mutex_);
        if (followed_.empty()) followed_ = head.device;
        ++report_.poses;
    }
    changed_.notify_all();
}

void TrackedDevice::take_status(const MessageHead& head, std::span<const std::byte> body) {
    const auto code = read_status_code(head, body);
    const std::lock_guard lock(mutex_);
    // A nameless or foreign STATUS tells of the server, as that with which 3D Slicer greets.
    if (followed_.empty() || head.device != followed_ || code == 1) return;
    publish(invalid_position);
    report_.last_problem =
        "STATUS of '" + head.device + "': " + (code ? "code " + std::to_string(*code) : "cut short");
}

void TrackedDevice::publish(std::uint32_t faults) {
    pose_.faults = faults;
    pose_.received_ns = now_ns();
    latest_.write(pose_);
}

void TrackedDevice::note(const std::string& problem) {
    const std::lock_guard lock(mutex_);
    report_.last_problem = problem;
}

bool TrackedDevice::wait_for_stop(milliseconds patience) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [this] { return stop_.load(); });
}

std::string TrackedDevice::what_was_heard() const {
    const std::string in_time = " in " + std::to_string(patience_.first_pose.count()) + " ms";
    if (!ever_connected_)
        return report_.last_problem.empty() ? "no connection" + in_time : report_.last_problem;
    if (heard_.empty())
        return (report_.last_problem.empty() ? "connected" : "connected, " + report_.last_problem) +
               ", but no message came" + in_time;
    std::string kinds;
    for (const auto& [kind, count] : heard_) kinds += (kinds.empty() ? "" : ", ") + kind;
    return "connected, but only " + kinds + " came" + in_time +
           (report_.last_problem.empty() ? "" : " (" + report_.last_problem + ")");
}

}  // namespace palpate::openigtlink
