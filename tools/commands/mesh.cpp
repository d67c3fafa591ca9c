// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/mesh.hpp"

#include <spdlog/spdlog.h>

#include "tools/cli/command.hpp"
#include "tools/meshing/files/mesh_files.hpp"

using namespace palpate;

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "mesh",
         .summary =
             "Fills labels with tetrahedra of good shape, or checks and converts a mesh made elsewhere.",
         .examples =
             {"palpate mesh --labels liver.seg.nrrd --region liver --region tumour --cell-size 8 "
              "--near tumour=4,10 -o liver.vtu",
              "palpate mesh --labels head.seg.nrrd --region wall --cell-size 4 --facet-distance 0.4 -o "
              "wall.vtu --json -",
              "palpate mesh --mesh-file liver.msh --unit cm --region-name 1=liver -o liver.vtu"},
         .notes = "Sizes are radii of circumscribed spheres; edges are about 1.2 times as long.\n"
                  "A mesh that misses the quality contract is made anew, finer where it missed, before the "
                  "command "
                  "fails with exit code 4. Limits in mm hold for voxels of up to 1 mm³ and grow with the "
                  "cube root "
                  "of larger ones.\n"
                  "Source: CGAL Mesh_3 (Jamin, Alliez, Yvinec, Boissonnat 2015)."});
    stages::MeshRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(request.output);
        imaging::set_imaging_threads(session.threads);
        stages::MadeMesh made = make_mesh(
            request, [&](std::string_view what, double done) { session.progress.step(what, done); },
            [](std::string_view text) { spdlog::info("{}", text); });
        meshing::write_tetrahedra(staged.path(), made.mesh);
        staged.commit();
        return made.result;
    });
}
