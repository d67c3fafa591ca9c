// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/organs/organ.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <span>

#include "formats/model/errors.hpp"
#include "tools/imaging/organs/organ_seeds.hpp"
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {
namespace {

// The grey value that seeds have where values are no HU, so that lengths of grey mean there what they mean in
// a CT of an organ: MRI has no scale of its own.
constexpr double seeds_grey = 120;

// The middle grey value around the seeds. Throws InvalidInput if one lies where there is next to no signal.
double grey_at(const Volume& volume, std::span<const Eigen::Vector3d> seeds, const Job& job) {
    constexpr double least_share = 0.25;  // tissues of an MRI differ by less, its air by more
    std::vector<float> greys;
    for (const Eigen::Vector3d& seed : seeds) {
        voxel_of_seed(volume.grid, seed, job.culprit());
        std::vector<float> near = values_near(volume, std::span(&seed, 1), seed_radius_mm);
        greys.push_back(static_cast<float>(robust_statistics(near).mean));
    }
    std::vector<float> sorted = greys;
    const double middle = robust_statistics(sorted).mean;
    for (std::size_t n = 0; n < seeds.size(); ++n)
        if (!(greys[n] > 0) || greys[n] < least_share * middle)
            throw InvalidInput(
                {job.culprit(),
                 fmt::format("it is dark around seed {} ({:g})", point_text(seeds[n]), greys[n]),
                 "tissue that gives signal",
                 "move it into the organ (LPS mm; 3D Slicer shows RAS, x and y negated)"});
    return middle;
}

Mask make_organ(const Job& job) {
    const Parameters& p = job.parameters;
    const std::vector<Eigen::Vector3d> seeds = few_seed_points(job);
    OrganParameters parameters{.tolerance_hu = p.number("tolerance"),
                               .drift_hu = p.number("drift"),
                               .neck_mm = p.number("neck_mm"),
                               .gap_mm = p.number("gap_mm")};
    if (seeds.empty() || holds_air(*job.volume))
        return organ(*job.volume, seeds, parameters, job.culprit(), job.note);
    parameters.per_hu = grey_at(*job.volume, seeds, job) / seeds_grey;
    parameters.unit = "";
    parameters.wall_mm = 0;  // what is bright is fat as often as bone
    parameters.darkest_hu = 0;
    parameters.brightest_hu = std::numeric_limits<double>::infinity();
    Volume scaled = *job.volume;
    for (float& value : scaled.values) value /= static_cast<float>(parameters.per_hu);
    return organ(scaled, seeds, parameters, job.culprit(), job.note);
}

}  // namespace

Recipe organ_recipe() {
    using enum RecipeParameter::Kind;
    using enum RecipeParameter::Range;
    return {.name = "organ",
            .meaning = "a solid organ in CT or MRI, from one to five seeds inside it",
            .parameters = concatenated(
                {{{"tolerance", number, "", "25",
                   fmt::format("grey values may be so far off the local mean: HU in a CT, else on a scale on "
                               "which the seeds have {}",
                               seeds_grey),
                   positive},
                  {"drift", number, "", "20",
                   "the local mean may be so far off that at the seeds, on the same scale", not_negative},
                  {"neck_mm", number, "mm", "6", "where no ball of this radius passes, the organ ends",
                   not_negative},
                  {"gap_mm", number, "mm", "4", "vessels, lesions and clefts below this radius are filled",
                   not_negative}},
                 seed_parameters(),
                 region_parameters(),
                 with_defaults(cleaning_parameters(), {{"keep_largest", "yes"}, {"smooth_mm", "3"}})}),
            .if_empty = "move the seeds into the organ, or check region and cleaning",
            .make = make_organ,
            .needs_volume = true,
            .needs_seeds = true};
}

}  // namespace palpate::imaging
