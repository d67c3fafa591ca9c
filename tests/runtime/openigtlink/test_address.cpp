// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "runtime/openigtlink/address.hpp"

namespace palpate {
namespace {

using namespace openigtlink;

TEST(TrackerAddress, reads_host_port_and_name) {
    const TrackerAddress whole = parse_tracker_address("tracker.lab:18944/StylusTipToReference");
    EXPECT_EQ(to_string(whole.server), "tracker.lab:18944");
    EXPECT_EQ(whole.tool, "StylusTipToReference");
    const TrackerAddress nameless = parse_tracker_address("10.0.0.7:1");
    EXPECT_EQ(nameless.server.host, "10.0.0.7");
    EXPECT_EQ(nameless.server.port, 1);
    EXPECT_EQ(nameless.tool, "");
    EXPECT_EQ(parse_tracker_address("a:1/b:2/c").tool, "b:2/c");
}

TEST(TrackerAddress, is_refused_by_the_text_that_was_given) {
    for (const char* text :
         {"", "localhost", ":18944", "localhost:", "localhost:0", "localhost:65536", "localhost:18944x",
          "localhost:-1", "::1:18944", "localhost:1/ABCDEFGHIJKLMNOPQRSTU"}) {
        try {
            parse_tracker_address(text);
            ADD_FAILURE() << "taken: " << text;
        } catch (const UsageError& error) {
            EXPECT_EQ(error.detail().culprit, text);
            EXPECT_FALSE(error.detail().next_step.empty());
        }
    }
}

TEST(StreamAddress, without_a_host_is_for_this_machine_alone) {
    EXPECT_EQ(to_string(parse_stream_address("18944")), "127.0.0.1:18944");
    EXPECT_EQ(to_string(parse_stream_address("0.0.0.0:18944")), "0.0.0.0:18944");
    EXPECT_THROW(parse_stream_address("port"), UsageError);
    EXPECT_THROW(parse_stream_address(""), UsageError);
    EXPECT_THROW(parse_stream_address("0.0.0.0:"), UsageError);
}

}  // namespace
}  // namespace palpate
