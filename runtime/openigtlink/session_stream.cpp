// SPDX-License-Identifier: Apache-2.0
#include "runtime/openigtlink/session_stream.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/openigtlink/tool_pose.hpp"

namespace palpate::openigtlink {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds client_patience{2};
constexpr double shortest_arrow = 1e-3;  // N: keeps the matrix of a force of zero invertible

Eigen::Vector3d ras(const std::array<double, 3>& lps) {
    return flip_lps_ras(Eigen::Map<const Eigen::Vector3d>(lps.data()));
}

// Of a tool whose orientation is known, in a message.
Eigen::Matrix3d axes_of(const Eigen::Quaterniond& orientation) {
    return flip_axes(orientation.normalized().toRotationMatrix());
}

std::string fixed(double value, int digits) {
    std::array<char, 400> text;  // the longest double has 309 digits before its point
    const auto [end, error] =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, digits);
    return {text.data(), end};
}

// "x y z N"
std::string vector_text(const Eigen::Vector3d& v, const char* unit) {
    return fixed(v.x(), 4) + " " + fixed(v.y(), 4) + " " + fixed(v.z(), 4) + " " + unit;
}

const StreamSettings& checked(const StreamSettings& settings) {
    if (settings.rate_hz > 0 && settings.rate_hz <= 1000) return settings;
    throw InvalidInput({"stream", "a rate of " + fixed(settings.rate_hz, 1) + " Hz",
                        "more than 0 and at most 1000 Hz", "60 Hz is what a screen shows"});
}

// Codes of the OpenIGTLink protocol's STATUS message.
std::uint16_t status_code(std::uint32_t fault) {
    switch (fault) {
        case no_fault:
            return 1;  // OK
        case device_lost:
            return 7;  // connection lost
        case not_calibrated:
            return 13;     // device not ready
        case pose_frozen:  //
        case motors_warm:  //
        case device_refused:
            return 18;  // hardware failure
        case servo_stopping:
            return 19;  // shut down in progress
        default:
            return 2;  // unknown error
    }
}

void append_fault_status(MessageBytes& out, std::uint64_t time, std::uint32_t faults) {
    const MessageOrigin origin{"PalpateStatus", time};
    for (const FaultText& text : fault_texts())
        if (faults & text.fault)
            return append_status(out, origin, status_code(text.fault), faults, text.name,
                                 fault_names(faults) + ": " + text.cause);
    append_status(out, origin, status_code(no_fault), 0, "", "no fault");
}

}  // namespace

SessionStream::SessionStream(const StreamSettings& settings)
    : settings_(checked(settings)), listener_(listen_at(settings.address)), port_(port_of(listener_)) {
    for (std::size_t tool = 0; tool < settings_.tool_count; ++tool)
        shown_.push_back(std::make_unique<realtime::TripleBuffer<Shown>>());
    thread_ = std::thread([this] { run(); });
}

SessionStream::~SessionStream() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    stopped_.notify_all();
    thread_.join();
}

void SessionStream::publish(const TickResult& result,
                            std::span<const Eigen::Vector3d> contact_points) noexcept {
    const auto tool = static_cast<std::size_t>(result.tool);
    if (tool >= shown_.size()) return;
    Shown& shown = shown_[tool]->back();
    shown.known = true;
    shown.result = result;
    shown.point_count = std::min(contact_points.size(), result.active_contacts().size());
    for (std::size_t i = 0; i < shown.point_count; ++i)
        shown.points[i] = {contact_points[i].x(), contact_points[i].y(), contact_points[i].z()};
    shown_[tool]->publish();
    faults_seen_.fetch_or(result.faults, std::memory_order_relaxed);
}

StreamReport SessionStream::report() const noexcept {
    return {connected_, frames_, skipped_, dropped_, refused_};
}

void SessionStream::run() {
    const auto period = std::chrono::duration_cast<steady_clock::duration>(
        std::chrono::duration<double>(1 / settings_.rate_hz));
    auto next = steady_clock::now();
    std::unique_lock lock(mutex_);
    while (!stopped_.wait_until(lock, next, [this] { return stop_; })) {
        lock.unlock();
        accept_clients();
        compose();
        std::uint32_t faults = faults_seen_.exchange(no_fault, std::memory_order_relaxed);
        for (const auto& shown : shown_) faults |= shown->front().result.faults;
        for (Client& client : clients_) serve(client, faults);
        std::erase_if(clients_, [](const Client& client) { return !client.socket.is_open(); });
        connected_ = clients_.size();
        next = std::max(next + period, steady_clock::now());
        lock.lock();
    }
}

void SessionStream::accept_clients() {
    while (true) {
        TcpSocket socket = accept_from(listener_);
        if (!socket.is_open()) return;
        if (clients_.size() == most_clients) {
            ++refused_;
            continue;
        }
        clients_.emplace_back().socket = std::move(socket);
    }
}

// Writes the frame of all tools that anything is known of.
void SessionStream::compose() {
    frame_is_new_ = false;
    for (const auto& shown : shown_) frame_is_new_ |= shown->refresh();
    if (!frame_is_new_) return;
    frame_.clear();
    const std::uint64_t time = message_time();
    for (std::size_t tool = 0; tool < shown_.size(); ++tool)
        if (shown_[tool]->front().known) append_tool(shown_[tool]->front(), tool, time);
}

void SessionStream::append_tool(const Shown& shown, std::size_t tool, std::uint64_t time) {
    const TickResult& result = shown.result;
    const std::string number = tool == 0 ? "" : std::to_string(tool + 1);
    const Eigen::Vector3d at_tool = ras(result.tool_position), at_device = ras(result.device_position);
    const Eigen::Vector3d force = ras(result.force), torque = ras(result.torque), shaft = ras(result.shaft);
    const Eigen::Quaterniond q_device = quaternion_of(result.orientation);
    const Eigen::Quaterniond q_tool = quaternion_of(result.tool_orientation);
    if (!(at_tool.allFinite() && at_device.allFinite() && force.allFinite() && torque.allFinite() &&
          shaft.allFinite() && q_device.coeffs().allFinite() && q_tool.coeffs().allFinite()))
        return;
    const bool turns = !q_tool.coeffs().isZero(0);

    const Eigen::Matrix3d led = q_device.coeffs().isZero(0) ? rotation_with_z(-shaft) : axes_of(q_device);
    append_transform(frame_, {"PalpateTool" + number, time}, turns ? axes_of(q_tool) : led, at_tool);
    append_transform(frame_, {"PalpateDevice" + number, time}, led, at_device);

    const std::string force_name = "PalpateForce" + number;
    Eigen::Matrix3d arrow = rotation_with_z(force.normalized());
    arrow.col(2) *= std::max(force.norm(), shortest_arrow);
    append_transform(frame_, {force_name, time}, arrow, at_tool);
    append_string(frame_, {force_name, time}, vector_text(force, "N"));
    if (turns) append_string(frame_, {"PalpateTorque" + number, time}, vector_text(torque, "N mm"));
    if (settings_.force_sensor) append_force_sensor(frame_, {force_name, time}, force);

    std::vector<std::string> labels;
    for (std::size_t i = 0; i < shown.point_count; ++i)
        labels.push_back(fixed(static_cast<double>(result.contacts[i].force), 2) + " N");
    std::vector<WirePoint> points;
    for (std::size_t i = 0; i < shown.point_count; ++i) points.push_back({ras(shown.points[i]), labels[i]});
    if (points.empty()) points.push_back({at_tool, "no contact", false});
    append_points(frame_, {"PalpateContacts" + number, time}, points);
}

void SessionStream::serve(Client& client, std::uint32_t faults) {
    drain(client);
    client.faults |= faults;
    client.behind |= frame_is_new_;
    flush(client);
    if (!client.socket.is_open()) return;
    if (!client.unsent.empty()) {
        skipped_ += frame_is_new_ ? 1 : 0;
        if (steady_clock::now() - client.last_progress > client_patience) {
            client.socket = {};
            ++dropped_;
        }
        return;
    }
    client.last_progress = steady_clock::now();
    if (!client.greeted || client.faults != client.told_faults) {
        append_fault_status(client.unsent, message_time(), client.faults);
        client.told_faults = client.faults;
    }
    client.faults = no_fault;
    if (client.behind && !frame_.empty()) {
        client.unsent.insert(client.unsent.end(), frame_.begin(), frame_.end());
        ++frames_;
    }
    client.behind = false;
    client.greeted = true;
    flush(client);
}

// Throws away what the client sent, at most 64 KiB of it at a time; closes it if it has gone.
void SessionStream::drain(Client& client) {
    std::array<std::byte, 4096> bytes;
    for (int i = 0; i < 16; ++i) {
        const auto count = client.socket.receive(bytes, std::chrono::milliseconds(0));
        if (!count) {
            client.socket = {};
            return;
        }
        if (*count == 0) return;
    }
}

void SessionStream::flush(Client& client) {
    if (!client.socket.is_open() || client.unsent.empty()) return;
    const auto count = client.socket.send(client.unsent);
    if (!count) {
        client.socket = {};
        return;
    }
    if (*count > 0) client.last_progress = steady_clock::now();
    client.unsent.erase(client.unsent.begin(), client.unsent.begin() + static_cast<std::ptrdiff_t>(*count));
}

}  // namespace palpate::openigtlink
