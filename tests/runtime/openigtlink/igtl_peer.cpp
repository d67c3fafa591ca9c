// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/openigtlink/igtl_peer.hpp"

#include <csignal>
#include <cstring>
#include <gtest/gtest.h>
#include <igtlPositionMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTransformMessage.h>
#include <igtl_header.h>
#include <igtl_util.h>

namespace palpate {
namespace {

using namespace openigtlink;

// The library's sockets raise it where the other end has gone.
const auto sigpipe_ignored = std::signal(SIGPIPE, SIG_IGN);

template <typename Message>
Bytes packed(Message& message) {
    message.Pack();
    const auto* begin = static_cast<const std::byte*>(message.GetPackPointer());
    return {begin, begin + message.GetPackSize()};
}

}  // namespace

Bytes transform_message(const std::string& device, const Rows& matrix) {
    auto message = igtl::TransformMessage::New();
    message->SetDeviceName(device.c_str());
    igtl::Matrix4x4 rows;
    for (std::size_t i = 0; i < 4; ++i) std::copy(matrix[i].begin(), matrix[i].end(), rows[i]);
    message->SetMatrix(rows);
    return packed(*message);
}

Bytes position_message(const std::string& device, const std::array<float, 3>& position,
                       const std::array<float, 4>& quaternion) {
    auto message = igtl::PositionMessage::New();
    message->SetDeviceName(device.c_str());
    message->SetPackType(igtl::PositionMessage::ALL);
    message->SetPosition(position.data());
    message->SetQuaternion(quaternion.data());
    return packed(*message);
}

Bytes status_message(const std::string& device, int code) {
    auto message = igtl::StatusMessage::New();
    message->SetDeviceName(device.c_str());
    message->SetCode(code);
    message->SetStatusString("as the test says");
    return packed(*message);
}

Bytes message(const std::string& type, const std::string& device, const Bytes& body, int version) {
    igtl_header head{};
    head.version = static_cast<igtl_uint16>(version);
    std::memcpy(head.name, type.data(), type.size());
    std::memcpy(head.device_name, device.data(), device.size());
    head.body_size = body.size();
    Bytes copy = body;
    head.crc = crc64(reinterpret_cast<unsigned char*>(copy.data()), copy.size(), 0);
    igtl_header_convert_byte_order(&head);
    Bytes out(sizeof(head) + body.size());
    std::memcpy(out.data(), &head, sizeof(head));
    std::copy(body.begin(), body.end(), out.begin() + sizeof(head));
    return out;
}

TrackerPeer::TrackerPeer() : server_(igtl::ServerSocket::New()) {
    EXPECT_EQ(server_->CreateServer(0), 0);
}

TrackerAddress TrackerPeer::address(const std::string& tool) const {
    return {{"127.0.0.1", static_cast<std::uint16_t>(server_->GetServerPort())}, tool};
}

bool TrackerPeer::accept() {
    connection_ = server_->WaitForConnection(long_enough.count());
    return connection_.IsNotNull();
}

void TrackerPeer::send(std::span<const std::byte> bytes) {
    connection_->Send(bytes.data(), static_cast<int>(bytes.size()));
}

void TrackerPeer::close_connection() {
    connection_->CloseSocket();
}

std::unique_ptr<TrackedDevice> TrackerPeer::device(const std::string& tool, const Bytes& first,
                                                   std::chrono::milliseconds pose_patience) {
    const TrackerAddress where = address(tool);
    auto made = std::async(std::launch::async, [where, pose_patience] {
        return std::make_unique<TrackedDevice>(where, TrackerPatience{long_enough, pose_patience});
    });
    EXPECT_TRUE(accept());
    send(first);
    return made.get();
}

WatchingPeer::WatchingPeer(int port)
    : socket_(igtl::ClientSocket::New()), connected_(socket_->ConnectToServer("127.0.0.1", port) == 0) {
    socket_->SetReceiveTimeout(static_cast<int>(long_enough.count()));
}

Received WatchingPeer::next() {
    auto head = igtl::MessageHeader::New();
    head->InitPack();
    if (socket_->Receive(head->GetPackPointer(), head->GetPackSize()) != head->GetPackSize()) return {};
    head->Unpack();
    Received out{head->GetDeviceType(), head->GetDeviceName(), head,
                 Bytes(static_cast<std::size_t>(head->GetBodySizeToRead()))};
    if (out.body.empty()) return out;
    const int size = static_cast<int>(out.body.size());
    return socket_->Receive(out.body.data(), size) == size ? out : Received{};
}

Received WatchingPeer::next(const std::string& type, const std::string& device) {
    const auto end = std::chrono::steady_clock::now() + long_enough;
    while (std::chrono::steady_clock::now() < end) {
        Received received = next();
        if (received.type.empty() || (received.type == type && received.device == device)) return received;
    }
    return {};
}

void WatchingPeer::send(std::span<const std::byte> bytes) {
    socket_->Send(bytes.data(), static_cast<int>(bytes.size()));
}

}  // namespace palpate
