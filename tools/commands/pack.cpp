// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "formats/asset/asset.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "tools/cli/command.hpp"
#include "tools/stages/case.hpp"

using namespace palpate;

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "pack",
         .summary =
             "Joins bodies, OBB trees and haptic settings to one asset that the trainer and ParaView open.",
         .examples = {"palpate pack --name liver --deformable liver=liver.body.h5 -o liver.vtkhdf",
                      "palpate pack --name head --rigid skull=skull.vtp,skull.obb.h5 "
                      "--deformable wall=wall.body.h5 --tool-radius 1.5 -o head.vtkhdf"},
         .notes = "Digests say whether parts belong together: an OBB tree to its surface, a compliance to "
                  "its mesh.\n"
                  "The provenance in the asset is the software's versions and the JSON given; no paths."});
    stages::PackRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(request.output);
        const Case patient_case = make_case(
            request, [&](std::string_view what, double done) { session.progress.step(what, done); });
        session.progress.step("write the asset", 0.5);
        asset::write_asset(staged.path(), patient_case);
        const std::string digest = asset::sha256_file(staged.path());
        const auto size = std::filesystem::file_size(staged.path());
        staged.commit();
        return nlohmann::ordered_json{{"asset", request.output.filename().string()},
                                      {"name", request.name},
                                      {"rigid_bodies", patient_case.rigid_bodies.size()},
                                      {"deformable_bodies", patient_case.deformable_bodies.size()},
                                      {"bytes", size},
                                      {"sha256", digest}};
    });
}
