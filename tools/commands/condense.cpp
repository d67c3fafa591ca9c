// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condensation/condense.hpp"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "formats/asset/parts.hpp"
#include "tools/cli/command.hpp"
#include "tools/commands/condense/arguments.hpp"
#include "tools/commands/condense/results.hpp"
#include "tools/fem/certificate/discretisation_error.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace {
using namespace palpate;

nlohmann::ordered_json to_json(const DeformableBody& body, const CondensationPlan& plan) {
    return {{"name", body.name},
            {"nodes", body.mesh.rest_positions.size()},
            {"tetrahedra", body.mesh.tetrahedra.size()},
            {"element_order", condensation::name_of(body.element_order)},
            {"surface_nodes", body.boundary.nodes.size()},
            {"fixed_nodes", body.fixed_nodes.size()},
            {"contact_nodes", body.contact_nodes.size()},
            {"representation", condensation::representation_of(body.compliance)},
            {"compliance_bytes", value_bytes(body.compliance)},
            {"plan", condensation::to_json(plan)},
            {"certificate", condensation::to_json(body.certificate)}};
}

void announce(const CondensationPlan& plan) {
    constexpr double mebibyte = 0x1p20;
    for (const CondensationForecast& forecast : plan.considered)
        spdlog::info("{}: about {:.0f} s, {:.0f} MiB of memory, {:.1f} MiB stored", name_of(forecast.method),
                     std::ceil(forecast.seconds), forecast.memory_bytes / mebibyte,
                     forecast.size_bytes / mebibyte);
    spdlog::info("chosen: {} ({})", name_of(plan.chosen.method), plan.reason);
}

}  // namespace

int main(int argc, char** argv) {
    restart_with_fitting_kernels(argv);
    std::filesystem::path input, output;
    std::string name, element = "linear", representation = "auto";
    double accuracy = 1e-3, memory_gib = 0, size_mib = 1024;
    bool discretisation_error = false;
    std::vector<std::string> materials, fixed, contact;
    cli::Command command(
        {.name = "condense",
         .summary = "Computes the surface compliance C = (K^-1)_ss of a tetrahedral body, exact or "
                    "compressed, with its certificate.",
         .examples = {"palpate condense liver.vtu --material liver:6.3,0.45 --material tumour:30,0.45 "
                      "--fixed sphere:20,60,-40,50 -o liver.body.h5",
                      "palpate condense wall.vtu --material wall:7.8,0.49 --element quadratic "
                      "--fixed touching:skull --contact touching:background -o wall.body.h5"},
         .notes = fmt::format(
             "Rules that pick nodes: {}.\n--fixed and --contact take the same rules, and several add up. "
             "Rules pick surface nodes; nodes:FILE may hold interior ones too. Only the nodes of the contact "
             "surface enter C, whose size grows with the square of their number; surface that is neither "
             "fixed "
             "nor contact surface deforms with the body here, but feels rigid when it is touched.\n"
             "Linear tetrahedra are too stiff where Poisson's ratio nears 0.5; quadratic ones are not, and "
             "have some eight times the unknowns.",
             node_rule_grammar)});
    command.input("mesh", input, "tetrahedra with CellData 'region' (.vtu), LPS mm").required();
    command
        .option("--material", materials, "material of a region: REGION:YOUNGS_MODULUS,POISSONS_RATIO",
                "kPa, 1")
        .required();
    command.option("--fixed", fixed, "rule that fixes nodes; several add up", "mm");
    command.option("--contact", contact,
                   "rule that picks the surface nodes that can be touched; several add up; without it, all "
                   "that are not fixed",
                   "mm");
    command.option("--element", element, "tetrahedra: linear (4 nodes) or quadratic (10 nodes)");
    command.option(
        "--representation", representation,
        "how to store C: dense (exact), hierarchical (compressed), or auto: dense if it fits --memory "
        "and --size");
    command
        .option("--accuracy", accuracy,
                "relative error that a hierarchical C may have: displacements under random contact loads")
        .range(1e-4, 0.1);
    command
        .option("--memory", memory_gib, "memory that may be in use at once; 0: what the machine has left",
                "GiB")
        .non_negative();
    command.option("--size", size_mib, "size that C may have in the file", "MiB").positive();
    command.flag(
        "--discretisation-error", discretisation_error,
        "estimate what the elements themselves miss, by solving on richer ones (some eight times the "
        "unknowns)");
    command.option("--name", name, "name of the body; the mesh file's name by default");
    command.output("-o,--output", output, "condensed body (.body.h5)").required();
    return command.run(argc, argv, [&](cli::Session& session) {
        const auto fixed_rules = condensation::parse_node_rules("--fixed", fixed);
        const auto contact_rules = condensation::parse_node_rules("--contact", contact);
        DeformableBody body;
        body.element_order = condensation::parse_element_order(element);
        cli::StagedFile staged = session.stage(output);
        set_linear_algebra_threads(session.threads);
        body.name = name.empty() ? input.stem().string() : name;
        body.mesh = read_tetrahedra(input);
        body.materials = condensation::parse_materials(materials, body.mesh, input.filename().string());
        const BoundarySurface boundary = boundary_surface(body.mesh);
        body.fixed_nodes = fixed_nodes_of(body.mesh, boundary, fixed_rules);
        body.contact_nodes = contact_nodes_of(body.mesh, boundary, contact_rules, body.fixed_nodes);
        const auto progress = [&](std::string_view what, double fraction) {
            session.progress.step(what, fraction);
        };
        progress("forecasting", 0);
        body = prepared_body(std::move(body));
        const CondensationPlan plan =
            plan_condensation(body, {.representation = condensation::parse_representation(representation),
                                     .accuracy = accuracy,
                                     .memory_bytes = memory_gib * 0x1p30,
                                     .size_bytes = size_mib * 0x1p20,
                                     .threads = session.threads});
        session.progress.finish();
        if (!session.quiet) announce(plan);
        body = condensed_body(std::move(body), plan, progress);
        if (discretisation_error) {
            progress("solving on richer elements", 0.95);
            body.certificate.discretisation_error = estimate_discretisation_error(body);
        }
        write_body_part(staged.path(), body);
        staged.commit();
        return to_json(body, plan);
    });
}
