// SPDX-License-Identifier: GPL-3.0-or-later
// Solves the strongest contact of a run of `palpate touch` again, directly on the asset's sparse stiffness:
// press_oracle ASSET.vtkhdf TOUCH.json prints the felt and the exact force (N), which points of the contact
// would pull (should be none) and how far any unloaded point lies inside the tool (mm).
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/asset/asset.hpp"
#include "runtime/haptics/contact/compliance_blocks.hpp"
#include "tests/tools/fem/certificate/direct_press.hpp"

int main(int, char** argv) {
    using namespace palpate;
    const Case patient = asset::read_asset(argv[1]);
    std::ifstream stream(argv[2]);
    const auto peak = nlohmann::json::parse(stream).at("peak");
    const DeformableBody& body = patient.deformable_bodies.at(0);

    const haptics::LoadSpread spread(body, haptics::compliance_blocks(body));
    std::vector<test::DirectContact> contacts;
    std::vector<bool> active;
    Eigen::VectorXd felt(peak["contacts"].size()), delta(felt.size());
    for (const auto& contact : peak["contacts"]) {
        const auto k = static_cast<Eigen::Index>(contacts.size());
        const std::vector<double> normal = contact["normal"];
        contacts.push_back(test::spread_over(body, spread,
                                             {contact["nodes"],
                                              contact["weights"],
                                              {normal[0], normal[1], normal[2]},
                                              contact["series_compliance_mm_per_n"]}));
        felt[k] = contact["force_n"];
        delta[k] = contact["gap_mm"];
        active.push_back(felt[k] > 0);
    }
    const Eigen::MatrixXd A = test::direct_compliance(body, contacts, peak["coupling_stiffness_n_per_mm"]);
    const Eigen::VectorXd exact = test::direct_forces(A, delta, active);
    std::cout << nlohmann::json{{"felt_n", felt.sum()},
                                {"exact_n", exact.sum()},
                                {"smallest_exact_n", exact.minCoeff()},
                                {"deepest_inside_mm", (delta - A * exact).maxCoeff()}}
              << '\n';
}
