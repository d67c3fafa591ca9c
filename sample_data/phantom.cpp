// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "sample_data/phantoms.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/files/image_files.hpp"

int main(int argc, char** argv) {
    using namespace palpate;
    cli::Command command({.name = "phantom",
                          .summary = "Writes a synthetic CT with its known truth",
                          .examples = {"phantom head head.nrrd head.seg.nrrd",
                                       "phantom abdomen a.nrrd a.seg.nrrd --spacing 1.5 --noise 20"},
                          .notes = "Sizes and places are in sample_data/phantoms.hpp."});
    std::string kind;
    std::filesystem::path volume, truth;
    PhantomOptions options;
    double spacing = options.spacing[0], angle_deg = 0;
    command.option("kind", kind, "abdomen or head").required().one_of({"abdomen", "head"});
    command.output("volume", volume, "CT (.nrrd)").required();
    command.output("truth", truth, "labels (.seg.nrrd)").required();
    command.option("--spacing", spacing, "voxel size", "mm");
    command.option("--angle", angle_deg, "turn of the grid about (1, 2, 3)", "degrees");
    command.option("--samples", options.samples_per_axis,
                   "partial volume: samples along each axis of a voxel");
    command.option("--noise", options.noise_hu, "standard deviation of the noise", "HU");
    command.option("--seed", options.seed, "of the noise");
    return command.run(argc, argv, [&](cli::Session& session) -> nlohmann::json {
        options.spacing.setConstant(spacing);
        options.direction =
            Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180, Eigen::Vector3d(1, 2, 3).normalized())
                .toRotationMatrix();
        const Phantom phantom = kind == "head" ? head_phantom(options) : abdomen_phantom(options);
        auto staged_volume = session.stage(volume);
        auto staged_truth = session.stage(truth);
        imaging::write_volume(staged_volume.path(), phantom.volume);
        imaging::write_label_map(staged_truth.path(), phantom.truth);
        staged_volume.commit();
        staged_truth.commit();
        return {{"size", phantom.volume.grid.size}};
    });
}
