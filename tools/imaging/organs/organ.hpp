// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

struct OrganParameters {
    double tolerance_hu;        ///< grey values may be so far off the organ's local mean
    double drift_hu;            ///< the local mean may be so far off that of the seeds nearby
    double neck_mm;             ///< where no ball of this radius passes, the organ ends
    double gap_mm;              ///< vessels, lesions and clefts below this radius are filled
    double darkest_hu = -50;    ///< a seed darker than this is a mistake
    double brightest_hu = 300;  ///< so is one brighter than this
    double wall_mm = 3;         ///< pleura and diaphragm between bone and organ are at least as thick
    double per_hu = 1;          ///< how much of the file's grey one HU is, where values are scaled
    std::string unit = " HU";   ///< of the file's grey, for notes
};

/// Finds a solid organ, such as the liver in CT with contrast or without, from points inside it (p_P, mm).
/// On blocks of about 2 mm: noise is smoothed along level sets, longer as long as what it makes around the
/// seeds would be as steep as the organ's border to muscle, or, where that leaves nothing of it, no longer;
/// the candidates are voxels within tolerance of a local mean, which starts from the seeds and then follows
/// what was found, without those on an edge (a gradient of three times the median in what was found) and
/// without the chest wall (bone, closed over the gaps between ribs, and wall_mm around it); the candidates
/// are cut at their necks and what holds no seed is dropped, until that changes little (8 rounds at most);
/// gaps are filled; a random walker finds the border within 5 mm of what was found, by edges and, where there
/// are none, by which local mean is nearer, the organ's or that of what lies around it; holes are filled.
/// `note` receives what a person should look at: seeds whose surroundings differ from the others'. Throws
/// InvalidInput naming `culprit` and the seed if there is none, one lies outside the volume or in something
/// darker or brighter than allowed; and if nothing as thick as neck_mm holds the seeds. Cost: linear in
/// voxels, but for the border's sparse system. Deterministic at any thread count. Source: the usual order for
/// the liver (Campadelli et al., 2009: smoothing, statistics from seeds, growth, cutting leaks by shape),
/// with the local means of Lankton and Tannenbaum (2008), the watershed of cut_at_necks() and random_walk().
Mask organ(const Volume& volume, std::span<const Eigen::Vector3d> seeds, const OrganParameters& parameters,
           const std::string& culprit, const std::function<void(std::string_view)>& note = {});

}  // namespace palpate::imaging
