// SPDX-License-Identifier: GPL-3.0-or-later
// Solves the strongest contact of a run of `palpate touch` again, directly on the asset's sparse stiffness:
// press_oracle ASSET.vtkhdf TOUCH.json prints the force felt on the tool and the exact one (N), which points
// of the contact would pull (should be none) and how far any unloaded point lies inside what presses it, and
// any loaded one of the felt forces is off it (mm). For an asset of one deformable body and rigid ones beside
// it.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/asset/asset.hpp"
#include "formats/model/contact/compliance_blocks.hpp"
#include "tests/tools/fem/certificate/direct_press.hpp"

namespace {

using namespace palpate;

// As the body sees it: what it presses, a rigid neighbour, presses back.
test::DirectContact on_body(const nlohmann::json& contact, const std::string& body) {
    const std::vector<double> n = contact["normal"];
    const Eigen::Vector3d normal(n[0], n[1], n[2]);
    if (contact["other_body"] == body)
        return {{contact["other_node"].get<std::int32_t>()}, {1}, -normal, 0, false};
    return {contact["nodes"], contact["weights"], normal, contact["series_compliance_mm_per_n"]};
}

// The forces on the tool. Those between bodies are not unique where a vertex presses two triangles that are
// nearly in one plane.
Eigen::VectorXd of_tool(const std::vector<test::DirectContact>& contacts, const Eigen::VectorXd& forces) {
    std::vector<double> found;
    for (std::size_t k = 0; k < contacts.size(); ++k)
        if (contacts[k].of_tool) found.push_back(forces[static_cast<Eigen::Index>(k)]);
    return Eigen::Map<Eigen::VectorXd>(found.data(), static_cast<Eigen::Index>(found.size()));
}

// Of all contacts that press, between bodies too: those forces may differ, what they displace must not.
double worst_where_pressed(const Eigen::VectorXd& residual, const std::vector<bool>& active) {
    double worst = 0;
    for (std::size_t k = 0; k < active.size(); ++k)
        if (active[k]) worst = std::max(worst, std::abs(residual[static_cast<Eigen::Index>(k)]));
    return worst;
}

}  // namespace

int main(int, char** argv) {
    const Case patient = asset::read_asset(argv[1]);
    std::ifstream stream(argv[2]);
    const auto peak = nlohmann::json::parse(stream).at("peak");
    const DeformableBody& body = patient.deformable_bodies.at(0);

    const haptics::LoadSpread spread(body, compliance_blocks(body));
    std::vector<test::DirectContact> contacts;
    std::vector<bool> active;
    Eigen::VectorXd felt(peak["contacts"].size()), delta(felt.size());
    for (const auto& contact : peak["contacts"]) {
        const auto k = static_cast<Eigen::Index>(contacts.size());
        contacts.push_back(test::spread_over(body, spread, on_body(contact, body.name)));
        felt[k] = contact["force_n"];
        delta[k] = contact["gap_mm"];
        active.push_back(felt[k] > 0);
    }
    const Eigen::MatrixXd A = test::direct_compliance(body, contacts, peak["coupling_stiffness_n_per_mm"]);
    const Eigen::VectorXd exact = test::direct_forces(A, delta, active);
    std::cout << nlohmann::json{{"felt_n", of_tool(contacts, felt).sum()},
                                {"exact_n", of_tool(contacts, exact).sum()},
                                {"smallest_exact_n", of_tool(contacts, exact).minCoeff()},
                                {"deepest_inside_mm", (delta - A * exact).maxCoeff()},
                                {"felt_residual_mm", worst_where_pressed(A * felt - delta, active)}}
              << '\n';
}
