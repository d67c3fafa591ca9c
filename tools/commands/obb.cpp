// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "formats/asset/parts.hpp"
#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/obb/build_obb_tree.hpp"

using namespace palpate;

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "obb",
         .summary = "Builds the tree of oriented bounding boxes over a surface.",
         .examples = {"palpate obb skull.vtp -o skull.obb.h5",
                      "palpate obb liver.vtu -o liver.obb.h5 --json -"},
         .notes = "Of tetrahedra the outer boundary is taken. Source: Gottschalk, Lin, Manocha 1996."});
    std::filesystem::path input, output;
    obb::ObbTreeOptions options;
    command.input("surface", input, "triangle surface (.vtp) or tetrahedra (.vtu), LPS mm").required();
    command.option("--leaf-triangles", options.max_leaf_triangles, "most triangles in a leaf")
        .range(1, most_leaf_triangles);
    command.output("-o,--output", output, "OBB tree (.obb.h5)").required();

    return command.run(argc, argv, [&](cli::Session& session) {
        if (input.extension() != ".vtp" && input.extension() != ".vtu")
            throw UsageError(
                {input.string(), "ends in '" + input.extension().string() + "'", ".vtp or .vtu", ""});
        cli::StagedFile staged = session.stage(output);
        session.progress.step("read", 0);
        const TriangleMesh surface = input.extension() == ".vtp"
                                         ? meshing::read_surface(input)
                                         : boundary_surface(meshing::read_tetrahedra(input)).surface;
        session.progress.step("build", 0.5);
        const ObbTree tree = obb::build_obb_tree(surface, options);
        asset::write_obb_part(staged.path(), tree, surface);
        staged.commit();
        const auto leaves =
            std::ranges::count_if(tree.nodes, [](const ObbNode& node) { return node.count > 0; });
        return nlohmann::json{
            {"triangles", surface.triangles.size()}, {"boxes", tree.nodes.size()}, {"leaves", leaves}};
    });
}
