// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "formats/asset/asset.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "tools/cli/command.hpp"
#include "tools/fem/feel/feel.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/stages/case.hpp"
#include "tools/stages/feel_result.hpp"
#include "tools/stages/image.hpp"

using namespace palpate;

namespace {
using Json = nlohmann::ordered_json;

// What cannot be felt, and what would be.
std::vector<std::string> unfelt(const Case& patient_case, int threads) {
    std::vector<std::string> warnings;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        for (const FeltRegion& felt : body.feel->regions)
            if (verdict_of(felt, body.feel->depth) != FeltVerdict::felt)
                warnings.push_back(stages::unfelt_warning(body, felt, fem::felt_trials(body, felt, threads)));
    return warnings;
}

}  // namespace

int main(int argc, char** argv) {
    fem::restart_with_fitting_kernels(argv);
    cli::Command command(
        {.name = "pack",
         .summary =
             "Joins bodies, OBB trees and haptic settings to one asset that the trainer and ParaView open.",
         .examples = {"palpate pack --name liver --deformable liver=liver.body.h5 -o liver.vtkhdf",
                      "palpate pack --name head --rigid skull=skull.vtp,skull.obb.h5 "
                      "--deformable wall=wall.body.h5 --tool-radius 1.5 -o head.vtkhdf"},
         .notes = "Digests say whether parts belong together: an OBB tree to its surface, a compliance to "
                  "its mesh.\n"
                  "What can be felt with the tool is computed and stored: the stiffness of the surface, and "
                  "what each\n"
                  "region makes of it; one that a hand cannot tell is warned of.\n"
                  "A scan is for the eye: the trainer shows its slices and paints it on what is cut open. A "
                  "head's shows the face.\n"
                  "The provenance in the asset is the software's versions and the JSON given; no paths."});
    stages::PackRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(request.output);
        fem::set_linear_algebra_threads(1);  // for last digits depend on it
        const auto [patient_case, to_look_at] =
            make_case(request, session.threads,
                      [&](std::string_view what, double done) { session.progress.step(what, done); });
        Json feel = Json::array(), felt = Json::array();
        for (const DeformableBody& body : patient_case.deformable_bodies) {
            feel.push_back(stages::feel_summary(body));
            for (Json& row : stages::felt_rows(body)) felt.push_back(std::move(row));
        }
        std::vector<std::string> warnings = unfelt(patient_case, session.threads);
        warnings.insert(warnings.end(), to_look_at.begin(), to_look_at.end());
        if (!request.scan.empty() && !patient_case.scan)
            warnings.push_back("the scan shows nothing of the bodies and is left out");
        for (const std::string& warning : warnings) spdlog::warn("{}", warning);
        session.progress.step("write the asset", 0.8);
        asset::write_asset(staged.path(), patient_case, request.sign);
        const std::string digest = asset::sha256_file(staged.path());
        const auto size = std::filesystem::file_size(staged.path());
        staged.commit();
        return Json{{"asset", request.output.filename().string()},
                    {"name", request.name},
                    {"rigid_bodies", patient_case.rigid_bodies.size()},
                    {"deformable_bodies", patient_case.deformable_bodies.size()},
                    {"scan", stages::scan_json(patient_case.scan)},
                    {"bytes", size},
                    {"sha256", digest},
                    {"feel", feel},
                    {"felt", felt},
                    {"warnings", warnings}};
    });
}
