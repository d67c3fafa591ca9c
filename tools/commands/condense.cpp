// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condense.hpp"

#include "formats/asset/parts.hpp"
#include "tools/cli/command.hpp"
#include "tools/commands/condense/arguments.hpp"
#include "tools/fem/parallel.hpp"
#include "tools/meshing/mesh_files.hpp"

namespace {
using namespace palpate;

nlohmann::json to_json(const DeformableBody& body) {
    const Certificate& c = body.certificate;
    return {{"name", body.name},
            {"nodes", body.mesh.rest_positions.size()},
            {"tetrahedra", body.mesh.tetrahedra.size()},
            {"element_order", condensation::name_of(body.element_order)},
            {"surface_nodes", body.boundary.nodes.size()},
            {"fixed_nodes", body.fixed_nodes.size()},
            {"contact_nodes", body.contact_nodes.size()},
            {"compliance_bytes", body.compliance.dof_count() * body.compliance.dof_count() * sizeof(float)},
            {"certificate",
             {{"residual", c.residual},
              {"residual_double", c.residual_double},
              {"asymmetry", c.asymmetry},
              {"reciprocity", c.reciprocity},
              {"smallest_eigenvalue_mm_per_n", c.smallest_eigenvalue},
              {"largest_eigenvalue_mm_per_n", c.largest_eigenvalue},
              {"condition_number", c.condition_number},
              {"sampled_columns", c.sampled_columns},
              {"free_dofs", c.free_dofs}}}};
}

}  // namespace

int main(int argc, char** argv) {
    std::filesystem::path input, output;
    std::string name, element = "linear";
    std::vector<std::string> materials, fixed, contact;
    cli::Command command(
        {.name = "condense",
         .summary = "Computes the exact surface compliance C = (K^-1)_ss of a tetrahedral body, "
                    "with its certificate.",
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
    command.input("mesh", input, "tetrahedra with CellData 'region' (.vtu), LPS mm")->required();
    command
        .option("--material", materials, "material of a region: REGION:YOUNGS_MODULUS,POISSONS_RATIO",
                "kPa, 1")
        ->required();
    command.option("--fixed", fixed, "rule that fixes nodes; several add up", "mm");
    command.option("--contact", contact,
                   "rule that picks the surface nodes that can be touched; several add up; without it, all "
                   "that are not fixed",
                   "mm");
    command.option("--element", element, "tetrahedra: linear (4 nodes) or quadratic (10 nodes)");
    command.option("--name", name, "name of the body; the mesh file's name by default");
    command.output("-o,--output", output, "condensed body (.body.h5)")->required();
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
        body = condensed_body(std::move(body), [&](std::string_view what, double fraction) {
            session.progress.step(what, fraction);
        });
        write_body_part(staged.path(), body);
        staged.commit();
        return to_json(body);
    });
}
