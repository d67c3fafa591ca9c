// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/stability/split.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <utility>

#include "formats/drawing/chart.hpp"
#include "runtime/haptics/contact/body_pair.hpp"
#include "tools/experiments/soft_ellipsoid.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate::experiments {
namespace {

using namespace haptics;
using drawing::Chart;
using drawing::Series;

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::array stiffness_ratios{1.0, 3.0, 10.0, 100.0};
constexpr std::array depths{0.5, 1.0, 2.0, 4.0};
constexpr double margin = 0.3;  // mm: nodes this near may be brought in by deformation

double extreme_z(const DeformableBody& body, double sign) {
    double extreme = -std::numeric_limits<double>::infinity();
    for (const Vector3d& p : body.boundary.surface.vertices) extreme = std::max(extreme, sign * p.z());
    return sign * extreme;
}

double deepest(std::span<const PairContact> contacts) {
    return contacts.empty() ? 0 : std::max(0.0, std::ranges::max(contacts, {}, &PairContact::gap).gap);
}

// How deep a node of one deformed surface lies below the other one, mm.
double gap_left(const std::array<const DeformableBody*, 2>& rest, const BodyPair& bodies,
                const Vector3d& offset, const PairForces& forces) {
    const auto deformed = [&](std::size_t side) {
        DeformableBody body = *rest[side];
        for (std::size_t v = 0; v < body.boundary.surface.vertices.size(); ++v)
            for (const VertexForce& load : forces[side])
                body.boundary.surface.vertices[v] +=
                    bodies[side].compliance(static_cast<std::int32_t>(v), load.vertex) * load.force;
        body.obb_tree = obb::build_obb_tree(body.boundary.surface);
        return ElasticSurface(body);
    };
    return deepest(find_contacts({deformed(0), deformed(1)}, offset, 0));
}

Vector3d net(const std::vector<VertexForce>& forces) {
    Vector3d sum = Vector3d::Zero();
    for (const VertexForce& load : forces) sum += load.force;
    return sum;
}

// |F_A + F_B| of the larger of both.
double net_imbalance(const PairForces& forces) {
    return (net(forces[0]) + net(forces[1])).norm() / std::max(net(forces[0]).norm(), net(forces[1]).norm());
}

// The forces of the nodes, handed on to the polygons that they are on by the weights of their feet, against
// those that the split found there: the worst difference, of the largest nodal force.
double nodal_imbalance(std::span<const PairContact> contacts, const PairForces& forces) {
    const auto is_inside = [](const PairContact& contact) { return contact.gap > 0; };
    const auto first = std::ranges::find_if(contacts, is_inside);
    const std::size_t giver = first->node_body;
    std::map<std::int32_t, Vector3d> sums;
    double largest = 0;
    for (const VertexForce& load : forces[1 - giver]) {
        sums[load.vertex] = load.force;
        largest = std::max(largest, load.force.norm());
    }
    for (const VertexForce& load : forces[giver]) {
        const auto on = std::ranges::find_if(contacts, [&](const PairContact& contact) {
            return is_inside(contact) && contact.node_body == giver && contact.node == load.vertex;
        });
        for (std::size_t i = 0; i < 3; ++i)
            sums.try_emplace(on->polygon[i], Vector3d::Zero()).first->second +=
                on->weights[static_cast<Index>(i)] * load.force;
        largest = std::max(largest, load.force.norm());
    }
    double worst = 0;
    for (const auto& [vertex, sum] : sums) worst = std::max(worst, sum.norm());
    return worst / largest;
}

struct Timed {
    PairSolution solution;
    double milliseconds = std::numeric_limits<double>::infinity();  // the fastest of some
};

Timed timed(PairSolution (*solve)(const BodyPair&, std::span<const PairContact>), const BodyPair& bodies,
            std::span<const PairContact> contacts) {
    constexpr int repetitions = 5;
    Timed result;
    for (int i = 0; i < repetitions; ++i) {
        const auto start = std::chrono::steady_clock::now();
        result.solution = solve(bodies, contacts);
        const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
        result.milliseconds = std::min(result.milliseconds, spent.count());
    }
    return result;
}

nlohmann::ordered_json scheme_json(const Timed& timed, const PairSolution& exact, double gap) {
    const PairSolution& solution = timed.solution;
    return {{"net_force_a_n", net(solution.forces[0]).norm()},
            {"net_force_b_n", net(solution.forces[1]).norm()},
            {"net_imbalance_percent", 100 * net_imbalance(solution.forces)},
            {"energy_over_exact", solution.energy / exact.energy},
            {"inside_linearised_mm", std::max(0.0, -std::ranges::min(solution.distances))},
            {"gap_left_mm", gap},
            {"milliseconds", timed.milliseconds}};
}

// One press of B, as it is, into A.
nlohmann::ordered_json press(const DeformableBody& a, const DeformableBody& b, const BodyPair& bodies,
                             double depth) {
    const Vector3d offset(0, 0, extreme_z(a, 1) - extreme_z(b, -1) - depth);
    const auto contacts = find_contacts(bodies, offset, margin);
    const auto inside = std::ranges::count_if(contacts, [](const auto& contact) { return contact.gap > 0; });
    const Timed exact = timed(solve_exactly, bodies, contacts),
                ratio = timed(split_by_force_ratio, bodies, contacts);
    const auto gap = [&](const Timed& of) { return gap_left({&a, &b}, bodies, offset, of.solution.forces); };
    nlohmann::ordered_json row{{"depth_mm", depth},
                               {"contacts", inside},
                               {"candidates", contacts.size()},
                               {"inside_before_mm", deepest(contacts)},
                               {"split", scheme_json(ratio, exact.solution, gap(ratio))},
                               {"exact", scheme_json(exact, exact.solution, gap(exact))}};
    row["split"]["nodal_imbalance_percent"] = 100 * nodal_imbalance(contacts, ratio.solution.forces);
    return row;
}

struct Pair {
    std::string name;
    DeformableBody a, b;  // equally stiff
};

std::vector<Pair> pairs() {
    const Ellipsoid organ{{30, 30, 20}, 5, 0.45, -1};
    const DeformableBody a = body_of(organ);
    std::vector<Pair> pairs;
    pairs.push_back({"alike", a, changed(a, 1, -1)});
    pairs.push_back({"finer", a, body_of({organ.semi_axes, 3.5, organ.poissons_ratio, 1})});
    pairs.push_back({"other", a, body_of({{16, 20, 24}, 3.5, 0.3, 1})});
    return pairs;
}

constexpr auto preamble =
    R"(Two ellipsoids of soft tissue are pressed into each other. A has semi-axes 30, 30, 20 mm, nodes 5 mm apart,
Poisson's ratio 0.45. B is `alike`: the mirror image of A, so that C_B is a multiple of C_A, mirrored; `finer`: the same
shape, nodes 3.5 mm apart; `other`: semi-axes 16, 20, 24 mm, nodes 3.5 mm apart, Poisson's ratio 0.3.

- E_B/E_A: stiffness. Depth: B's lowest node below A's highest. Contacts: nodes inside, both ways.
- Net: |F_A + F_B| of the larger force. F_A, F_B: net forces of the split, of the exact one.
- Nodal: worst difference of a node's force and what its polygon bears, of the largest nodal force. The exact
  solution's is balanced by construction.
- Energy: elastic, split / exact; below 1 the bodies are not parted.
- Left: the deepest node of a deformed surface below the other. ms: one solution, matrices and allocation included,
  the fastest of five.

| B | E_B/E_A | depth mm | contacts | net % split | exact | nodal % split | F_A | F_B | energy | left mm before | split | exact | ms split | exact |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
)";

std::string table_row(const std::string& name, double ratio, const nlohmann::ordered_json& row) {
    const auto of = [&](const char* scheme, const char* what) { return row[scheme][what].get<double>(); };
    const double force = of("exact", "net_force_a_n");
    return fmt::format(
        "| {} | {} | {} | {} | {:.1f} | {:.0e} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | "
        "{:.3f} | {:.1f} | {:.1f} |\n",
        name, ratio, row["depth_mm"].get<double>(), row["contacts"].get<int>(),
        of("split", "net_imbalance_percent"), of("exact", "net_imbalance_percent"),
        of("split", "nodal_imbalance_percent"), of("split", "net_force_a_n") / force,
        of("split", "net_force_b_n") / force, of("split", "energy_over_exact"),
        row["inside_before_mm"].get<double>(), of("split", "gap_left_mm"), of("exact", "gap_left_mm"),
        of("split", "milliseconds"), of("exact", "milliseconds"));
}

}  // namespace

Findings split(const Options&, cli::Session& session) {
    session.progress.step("meshing and condensing", 0);
    Chart imbalance{.title = "Net force that the split by force ratio leaves, 2 mm deep",
                    .x_label = "stiffness of B / stiffness of A",
                    .y_label = "|F_A + F_B| / |F| (%)",
                    .log_x = true};
    Chart left{.title = "What is left of the intersection, equally stiff",
               .x_label = "depth (mm)",
               .y_label = "deepest node (mm)"};
    Findings findings{
        .result = {{"schema", "palpate.bench.split/1"}, {"pairs", nlohmann::ordered_json::array()}},
        .table = preamble,
        .pictures = {}};
    const std::vector<Pair> all = pairs();
    for (std::size_t p = 0; p < all.size(); ++p) {
        const Pair& pair = all[p];
        Series net_split{.name = pair.name}, left_split{.name = pair.name + ", split"},
            left_exact{.name = pair.name + ", exact"};
        for (const double ratio : stiffness_ratios) {
            session.progress.step(fmt::format("{}, 1 : {}", pair.name, ratio),
                                  static_cast<double>(p + 1) / static_cast<double>(all.size() + 1));
            const DeformableBody b = changed(pair.b, ratio, 1);
            const BodyPair bodies{ElasticSurface(pair.a), ElasticSurface(b)};
            for (const double depth : depths) {
                nlohmann::ordered_json row = press(pair.a, b, bodies, depth);
                findings.table += table_row(pair.name, ratio, row);
                if (depth == 2) {
                    net_split.x.push_back(ratio);
                    net_split.y.push_back(row["split"]["net_imbalance_percent"]);
                }
                if (ratio == 1) {
                    left_split.x.push_back(depth);
                    left_split.y.push_back(row["split"]["gap_left_mm"]);
                    left_exact.x.push_back(depth);
                    left_exact.y.push_back(row["exact"]["gap_left_mm"]);
                }
                row["b"] = pair.name;
                row["stiffness_ratio"] = ratio;
                findings.result["pairs"].push_back(std::move(row));
            }
        }
        imbalance.series.push_back(std::move(net_split));
        left.series.push_back(std::move(left_split));
        left.series.push_back(std::move(left_exact));
    }
    findings.pictures.emplace_back("split", drawing::charts_svg({imbalance, left}));
    return findings;
}

}  // namespace palpate::experiments
