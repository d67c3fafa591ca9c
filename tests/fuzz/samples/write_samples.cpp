// SPDX-License-Identifier: Apache-2.0
// write_fuzz_samples FOLDER: small files that the readers of formats take, in a folder for each reader.
#include "formats/asset/asset.hpp"
#include "formats/asset/parts.hpp"
#include "formats/recording/recording_writer.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

void write_assets(const fs::path& folder) {
    fs::create_directories(folder);
    Case patient_case = sample::sample_case(2);
    RigidBody& skull = patient_case.rigid_bodies[0];
    skull.surface = sample::sphere_surface({40, 10, 10}, 15, 1);
    skull.obb_tree = sample::median_tree(skull.surface, 4);
    DeformableBody& wall = patient_case.deformable_bodies[0];
    wall.relaxation = {{1, {.share = 0.25, .time = 2}}};
    asset::write_obb_part(folder / "skull.obb.h5", skull.obb_tree, skull.surface);
    asset::write_body_part(folder / "wall.body.h5", wall);
    asset::write_asset(folder / "dense.vtkhdf", patient_case);
    constexpr double accuracy = 1e-3;
    wall = sample::with_hierarchical_compliance(wall, 3, accuracy);
    asset::write_asset(folder / "hierarchical.vtkhdf", patient_case);
}

void write_recordings(const fs::path& folder) {
    fs::create_directories(folder);
    const recording::RecordingHead head{.palpate_version = "1.2.3",
                                        .case_name = "sample",
                                        .asset_digest = std::string(64, 'a'),
                                        .scheme = "continuous",
                                        .clock = "real",
                                        .coupling_stiffness = 0.4,
                                        .haptics = {.tool_radius = 1.5},
                                        .devices = {{"left", {.max_force = 3.3}}, {"right", {}}},
                                        .tool = ToolBody{sample::sphere_surface({0, 0, 0}, 2, 0), {}},
                                        .jaws = JawSettings{},
                                        .hyperelastic = {"wall"}};
    for (const int ticks : {5, 40}) {  // a ring of 16 rows: begun, and gone round
        const fs::path path = folder / ("ticks_" + std::to_string(ticks) + ".h5");
        recording::make_recording(path, head, 16);
        recording::RecordingWriter writer(path);
        for (std::int64_t row = 0; row < ticks; ++row) {
            const std::vector<Contact> contacts(static_cast<std::size_t>(row % 4));
            Tick tick;
            tick.tick = row / 2;
            tick.tool = static_cast<std::int32_t>(row % 2);
            tick.contact_count = static_cast<std::int32_t>(contacts.size());
            tick.detected_tick = tick.tick - 1;
            writer.add(tick, contacts);
        }
    }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::filesystem::path folder = argv[1];
    palpate::write_assets(folder / "asset");
    palpate::write_recordings(folder / "recording");
    return 0;
}
