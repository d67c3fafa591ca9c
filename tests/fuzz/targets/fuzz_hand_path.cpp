// SPDX-License-Identifier: Apache-2.0
// Hand's paths and recordings of one axis (text).
#include "runtime/devices/hand_path.hpp"
#include "tests/fuzz/feed.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 128, .base = std::size_t{1} << 20};
    fuzz::feed({data, size}, "fuzzed.txt", cap, [](const std::filesystem::path& file) {
        const devices::HandPath path = devices::read_hand_path(file);
        for (const double part : {0.0, 0.3, 1.0}) {
            path.at(part * path.duration());
            path.orientation_at(part * path.duration());
        }
        devices::mapped_path(path, Eigen::Isometry3d::Identity());
    });
    fuzz::feed({data, size}, "fuzzed.txt", cap, [](const std::filesystem::path& file) {
        const std::vector<double> values = devices::read_column(file, 2);
        const devices::TouchPoint place{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
        devices::recorded_axis_path(place, {}, values);
    });
    return 0;
}
