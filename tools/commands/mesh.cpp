// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/mesh.hpp"

#include <spdlog/spdlog.h>

#include "tools/cli/command.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/report/pictures/preview.hpp"
#include "tools/report/pictures/virtual_display.hpp"

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
         .notes =
             "Sizes are radii of circumscribed spheres; edges are about 1.2 times as long.\n"
             "A mesh that misses the quality contract is made anew, finer where it missed, before the "
             "command "
             "fails with exit code 4. Limits in mm hold for voxels of up to 1 mm³ and grow with the "
             "cube root "
             "of larger ones.\n"
             "The picture of --preview is drawn on the display that DISPLAY names, without one on an Xvfb "
             "of its own.\n"
             "Source: CGAL Mesh_3 (Jamin, Alliez, Yvinec, Boissonnat 2015)."});
    stages::MeshRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(request.output);
        std::optional<cli::StagedFile> preview;
        std::optional<report::VirtualDisplay> display;
        if (!request.preview.empty()) {
            preview.emplace(request.preview, session.force);
            display.emplace();
        }
        imaging::set_imaging_threads(session.threads);
        stages::MadeMesh made = make_mesh(
            request, [&](std::string_view what, double done) { session.progress.step(what, done); },
            [](std::string_view text) { spdlog::info("{}", text); });
        if (preview) {
            session.progress.step("drawing", 0.97);
            preview->write_text(report::mesh_preview_png(made.mesh));
            preview->commit();
            spdlog::info("a picture of the mesh is in {}", request.preview.string());
        }
        if (made.shortfall) {
            if (preview) made.shortfall->next_step += "; " + request.preview.string() + " shows the mesh";
            throw QualityNotMet(*made.shortfall);
        }
        meshing::write_tetrahedra(staged.path(), made.mesh);
        staged.commit();
        return made.result;
    });
}
