// SPDX-License-Identifier: Apache-2.0
// Poses off the network (OpenIGTLink): a head and whatever follows it as body.
#include "runtime/openigtlink/read_message.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate::openigtlink;
    if (size < MessageHead::size) return 0;
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto head = read_head(bytes.first<MessageHead::size>());
    if (!head) return 0;
    const auto body = bytes.subspan(MessageHead::size);
    crc_fits(*head, body);
    if (carries_pose(*head)) read_pose(*head, body);
    read_status_code(*head, body);
    return 0;
}
