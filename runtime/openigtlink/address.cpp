// SPDX-License-Identifier: Apache-2.0
#include "runtime/openigtlink/address.hpp"

#include <charconv>
#include <igtl_header.h>

#include "formats/model/errors.hpp"

namespace palpate::openigtlink {
namespace {

constexpr const char* tracker_example = "write HOST:PORT or HOST:PORT/NAME, as in 127.0.0.1:18944/Stylus";
constexpr const char* stream_example = "write PORT or ADDRESS:PORT, as in 18944 or 0.0.0.0:18944";

std::uint16_t parse_port(std::string_view digits, std::string_view text, const char* example) {
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (error != std::errc{} || end != digits.data() + digits.size() || port == 0)
        throw UsageError({std::string(text), "port '" + std::string(digits) + "'", "1 ... 65535", example});
    return port;
}

TcpAddress parse_address(std::string_view address, std::string_view text, const char* example) {
    const std::size_t colon = address.rfind(':');
    if (colon == std::string_view::npos || colon == 0)
        throw UsageError({std::string(text), "no host", "a host's name or IPv4 address before ':'", example});
    const std::string_view host = address.substr(0, colon);
    if (host.find(':') != std::string_view::npos)
        throw UsageError({std::string(text), "host '" + std::string(host) + "'",
                          "a host's name or IPv4 address", example});
    return {std::string(host), parse_port(address.substr(colon + 1), text, example)};
}

}  // namespace

std::string to_string(const TcpAddress& address) {
    return address.host + ":" + std::to_string(address.port);
}

TrackerAddress parse_tracker_address(std::string_view text) {
    const std::size_t slash = text.find('/');
    const std::string_view tool = slash == std::string_view::npos ? "" : text.substr(slash + 1);
    if (tool.size() > IGTL_HEADER_NAME_SIZE)
        throw UsageError({std::string(text), "a name of " + std::to_string(tool.size()) + " bytes",
                          "20 bytes at most, as OpenIGTLink sends them",
                          "give the name as it is sent, cut after 20 bytes"});
    return {parse_address(text.substr(0, slash), text, tracker_example), std::string(tool)};
}

TcpAddress parse_stream_address(std::string_view text) {
    if (text.find(':') == std::string_view::npos)
        return {"127.0.0.1", parse_port(text, text, stream_example)};
    return parse_address(text, text, stream_example);
}

}  // namespace palpate::openigtlink
