// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condense.hpp"

#include <algorithm>
#include <charconv>

#include "formats/asset/parts.hpp"
#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/fem/boundary_conditions.hpp"
#include "tools/meshing/mesh_files.hpp"

namespace {
using namespace palpate;

// Reads "liver:6.3,0.45": region name, Young's modulus in kPa, Poisson's ratio.
RegionMaterial parse_material(const std::string& text, const TetMesh& mesh, const std::string& mesh_name) {
    const auto colon = text.rfind(':');
    const auto comma = text.find(',', colon == std::string::npos ? 0 : colon);
    double modulus_kpa = 0, ratio = 0;
    const auto number = [&](std::size_t begin, std::size_t end, double& value) {
        return std::from_chars(text.data() + begin, text.data() + end, value).ptr == text.data() + end;
    };
    if (colon == std::string::npos || comma == std::string::npos || !number(colon + 1, comma, modulus_kpa) ||
        !number(comma + 1, text.size(), ratio))
        throw UsageError({"--material " + text, "cannot be read", "REGION:YOUNGS_MODULUS_KPA,POISSONS_RATIO",
                          "for example liver:6.3,0.45"});
    const Label region = require_label(mesh.region_names, text.substr(0, colon), mesh_name);
    return {region.value, {.youngs_modulus = modulus_kpa * 1e-3, .poissons_ratio = ratio}};
}

nlohmann::json to_json(const DeformableBody& body) {
    const Certificate& c = body.certificate;
    return {{"name", body.name},
            {"nodes", body.mesh.rest_positions.size()},
            {"tetrahedra", body.mesh.tetrahedra.size()},
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
    std::string name;
    std::vector<std::string> materials, fixed;
    cli::Command command(
        {.name = "condense",
         .summary = "Computes the exact surface compliance C = (K^-1)_ss of a tetrahedral body, "
                    "with its certificate.",
         .examples = {"palpate condense liver.vtu --material liver:6.3,0.45 --material tumour:30,0.45 "
                      "--fixed sphere:20,60,-40,50 -o liver.body.h5",
                      "palpate condense wall.vtu --material wall:7.8,0.45 --fixed touching:skull "
                      "--fixed touching:background -o wall.body.h5"},
         .notes = "Rules that fix surface nodes: touching:LABEL (what lies beyond the surface; "
                  "'background' for none), box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r, "
                  "plane:x,y,z,nx,ny,nz (the side its normal points to)."});
    command.input("mesh", input, "tetrahedra with CellData 'region' (.vtu), LPS mm")->required();
    command
        .option("--material", materials, "material of a region: REGION:YOUNGS_MODULUS,POISSONS_RATIO",
                "kPa, 1")
        ->required();
    command.option("--fixed", fixed, "rule that fixes surface nodes; several add up", "mm");
    command.option("--name", name, "name of the body; the mesh file's name by default");
    command.output("-o,--output", output, "condensed body (.body.h5)")->required();
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(output);
        set_linear_algebra_threads(session.threads);
        DeformableBody body;
        body.name = name.empty() ? input.stem().string() : name;
        body.mesh = read_tetrahedra(input);
        for (const std::string& text : materials)
            body.materials.push_back(parse_material(text, body.mesh, input.filename().string()));
        std::ranges::sort(body.materials, {}, &RegionMaterial::region);
        std::vector<FixedRule> rules;
        for (const std::string& text : fixed) rules.push_back(parse_fixed_rule(text));
        body.fixed_nodes = fixed_nodes_of(body.mesh, boundary_surface(body.mesh), rules);
        body = condensed_body(std::move(body), [&](std::string_view what, double fraction) {
            session.progress.step(what, fraction);
        });
        write_body_part(staged.path(), body);
        staged.commit();
        return to_json(body);
    });
}
