// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "formats/asset/asset.hpp"
#include "formats/asset/hdf5/signature.hpp"
#include "formats/asset/validate.hpp"
#include "formats/asset/vtk_grid.hpp"
#include "formats/elasticity/plausible_compliance.hpp"
#include "formats/model/errors.hpp"
#include "tools/archive/privacy/find_identity.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/outputs/staged_file.hpp"
#include "tools/fem/certificate/certificate.hpp"
#include "tools/fem/certificate/claims.hpp"
#include "tools/fem/certificate/contact_loads.hpp"
#include "tools/fem/feel/feel.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/meshing/files/surface_repair.hpp"
#include "tools/meshing/surfaces/overlaps.hpp"

namespace {
using namespace palpate;
using namespace palpate::fem;
using Json = nlohmann::ordered_json;

// Round-off of float32 in what is stored and of another order of sums in what is solved again.
constexpr double feel_limit = 1e-5;

// The checks made so far, as the rows of a table.
class Checks {
  public:
    void add(const std::string& what, const std::string& check, bool ok, const Json& figure,
             const std::string& expected) {
        rows_.push_back({{"of", what},
                         {"check", check},
                         {"status", ok ? "ok" : "failed"},
                         {"figure", figure},
                         {"expected", expected}});
        if (!ok) failed_.push_back(what + ": " + check);
    }

    const Json& rows() const { return rows_; }
    const std::vector<std::string>& failed() const { return failed_; }

  private:
    Json rows_ = Json::array();
    std::vector<std::string> failed_;
};

// Largest relative difference of the surface's stiffness, and largest difference in what regions make of it.
std::pair<double, double> feel_differences(const Feel& stored, const Feel& fresh) {
    constexpr double all = 1;
    if (stored.regions.size() != fresh.regions.size()) return {all, all};
    double stiffness = std::abs(stored.depth / fresh.depth - 1), regions = 0;
    for (std::size_t v = 0; v < fresh.stiffness.size(); ++v) {
        const double here{fresh.stiffness[v]}, there{stored.stiffness[v]};
        stiffness = std::max(stiffness, here > 0 ? std::abs(there / here - 1) : there);
    }
    for (std::size_t i = 0; i < fresh.regions.size(); ++i) {
        const FeltRegion &here = fresh.regions[i], &there = stored.regions[i];
        if (here.region != there.region) return {stiffness, all};
        for (const double difference :
             {contrast_of(there) - contrast_of(here), there.variation - here.variation,
              there.depth - here.depth, there.stiffness_without / here.stiffness_without - 1})
            regions = std::max(regions, std::abs(difference));
    }
    return {stiffness, regions};
}

void check_feel(Checks& checks, const DeformableBody& body, int threads) {
    const Feel fresh = feel_of(body, body.feel->tool_radius, threads);
    const auto [stiffness, regions] = feel_differences(*body.feel, fresh);
    const std::string limit = fmt::format("at most {:g}", feel_limit);
    checks.add(body.name, "stiffness under the tool, worst relative difference of a vertex pressed again",
               stiffness <= feel_limit, stiffness, limit);
    checks.add(body.name, "contrast, variation and depth of regions, worst difference computed again",
               regions <= feel_limit, regions, limit);
}

void check_mechanics(Checks& checks, const DeformableBody& body, std::int32_t columns, std::int32_t loads,
                     int threads) {
    const auto add_error = [&](const std::string& what, double error, double limit) {
        checks.add(body.name, what, error <= limit, error, fmt::format("at most {:g}", limit));
    };
    try {
        const Certificate fresh = recertify(body, columns, loads, recheck_seed);
        checks.add(body.name, "stiffness is positive definite", true, fresh.free_dofs,
                   "free degrees of freedom");
        checks.add(body.name, "compliance is symmetric, max |C - C^T| / max |C|", fresh.asymmetry == 0,
                   fresh.asymmetry, "0");
        if (std::holds_alternative<DenseCompliance>(body.compliance))
            checks.add(body.name, "compliance is positive definite, smallest eigenvalue in mm/N",
                       fresh.smallest_eigenvalue > 0, fresh.smallest_eigenvalue, "above 0");
        checks.add(body.name,
                   fmt::format("positive definite on {} contacts, smallest eigenvalue in mm/N", loads),
                   fresh.smallest_patch_eigenvalue > 0, fresh.smallest_patch_eigenvalue, "above 0");
        add_error(fmt::format("residual of {} re-solved columns", columns), fresh.residual,
                  allowed_error(body.compliance));
        const LoadError allowed = allowed_load_error(body, {fresh.load_error, fresh.contact_error},
                                                     fresh.sampled_loads, recheck_seed);
        add_error(fmt::format("displacements under {} re-solved contact loads", loads), fresh.load_error,
                  allowed.surface);
        add_error("the same, at the loaded nodes", fresh.contact_error, allowed.contact);
        const auto answer = elasticity::worst_answer(body, recheck_seed);
        checks.add(body.name, "what touch asks of C: worst contact node, part of its displacement",
                   answer && answer->part() <= elasticity::most_off, answer ? Json(answer->part()) : Json(),
                   fmt::format("at most {:g}", elasticity::most_off));
        for (const Claim& claim : recheck_claims(body))
            checks.add(body.name, "the certificate's " + claim.figure + ", measured again", claim.holds,
                       claim.found, claim.allowed);
        if (body.feel) check_feel(checks, body, threads);
    } catch (const InvalidInput& error) {
        checks.add(body.name, "stiffness is positive definite", false, error.what(), "enough fixed nodes");
    }
}

// What no reader of ours looks at, such as units, may be wrong for another's.
void check_writing(Checks& checks, const std::filesystem::path& asset, const Case& patient_case) {
    const cli::StagedFile again(std::filesystem::temp_directory_path() / "palpate-verify.vtkhdf", true);
    const auto unlike = asset::unlike_written_again(asset, patient_case, again.path());
    checks.add("asset", "units, texts and values are those of the asset written again", unlike.empty(),
               unlike.empty() ? "" : unlike.front(), "");
}

// The nodes of the surface, and they alone, have something beyond them.
void check_outside(Checks& checks, const DeformableBody& body) {
    const std::vector<std::int32_t>& labels = body.mesh.outside_labels;
    std::vector<bool> is_outside(labels.size(), false);
    if (!labels.empty())
        for (const std::int32_t node : body.boundary.nodes) is_outside[static_cast<std::size_t>(node)] = true;
    std::int64_t wrong = 0;
    for (std::size_t node = 0; node < labels.size(); ++node) wrong += (labels[node] >= 0) != is_outside[node];
    checks.add(body.name, "what lies beyond is told of surface nodes alone, nodes otherwise", wrong == 0,
               wrong, "none");
}

// Tissue that is there twice would be felt twice.
void check_overlap(Checks& checks, const DeformableBody& body) {
    const auto place = meshing::place_of_overlap(body.boundary.surface);
    checks.add(body.name, "no part lies where another does, place in mm", !place,
               place ? Json({place->x(), place->y(), place->z()}) : Json(), "none");
}

void check_sides(Checks& checks, const RigidBody& body) {
    std::string wrong;
    try {
        meshing::require_sound_surface(body.surface, body.name);
    } catch (const InvalidInput& error) {
        wrong = error.what();
    }
    checks.add(body.name, "surface is closed and its triangles face outwards", wrong.empty(), wrong, "");
}

Json verify(const std::filesystem::path& asset, const std::vector<std::filesystem::path>& trusted,
            std::int32_t columns, std::int32_t loads, cli::Session& session) {
    set_linear_algebra_threads(session.threads);
    session.progress.step("read and check digests", 0);
    const auto keys = asset::read_public_keys(trusted);
    const Case patient_case = asset::read_asset(asset, keys);
    Checks checks;
    if (const auto signer = asset::signer_of(asset))
        checks.add("asset",
                   keys.empty() ? "signature holds, of a key that nobody vouched for here"
                                : "signature holds, of a trusted key",
                   true, *signer, "");
    checks.add("asset", "every digest and the manifest", true, std::filesystem::file_size(asset), "bytes");
    checks.add("asset", "every index in range, every number finite and plausible", true, "", "");
    checks.add("asset", "boxes enclose their triangles, mm outside", true, "",
               fmt::format("at most {:g}", asset::farthest_escape));
    const auto shown = asset::vtk_grid_difference(asset, patient_case);
    checks.add("asset", "what ParaView shows are the bodies", !shown, shown.value_or(""), "");
    check_writing(checks, asset, patient_case);
    checks.add("asset", "provenance is JSON or empty",
               patient_case.provenance.empty() || Json::accept(patient_case.provenance), "", "");
    for (const RigidBody& body : patient_case.rigid_bodies) check_sides(checks, body);
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        session.progress.step("solve " + body.name + " again", 0.5);
        checks.add(body.name, "compliance, mesh, material and boundary belong together", true,
                   body.contact_nodes.size(), "contact nodes");
        check_outside(checks, body);
        check_overlap(checks, body);
        check_mechanics(checks, body, columns, loads, session.threads);
    }
    if (!checks.failed().empty())
        session.shortfall =
            ErrorDetail{asset.string(),
                        fmt::format("{} of {} checks failed, first '{}'", checks.failed().size(),
                                    checks.rows().size(), checks.failed().front()),
                        "none", "build the case again"};
    return Json{{"name", patient_case.name},
                {"verdict", checks.failed().empty() ? "ok" : "failed"},
                {"checks", checks.rows()}};
}

// A line for each finding, values shortened.
Json verify_privacy(const std::vector<std::filesystem::path>& files, cli::Session& session) {
    const archive::PrivacyReport report = archive::find_identity(files, archive::this_machine());
    Json rows = Json::array();
    for (const archive::Finding& finding : report.findings) {
        rows.push_back({{"file", finding.file.string()},
                        {"where", finding.where},
                        {"kind", finding.kind},
                        {"value", finding.value}});
        session.text += fmt::format("{}: {}: {}: {}\n", finding.file.string(), finding.where, finding.kind,
                                    finding.value);
    }
    session.text += fmt::format("{} files searched, {} findings\n", report.files, rows.size());
    if (!rows.empty())
        session.shortfall = ErrorDetail{files.front().string() + (files.size() > 1 ? " and others" : ""),
                                        fmt::format("{} findings of identity or place", rows.size()), "none",
                                        "do not hand them on; import or export again without identity"};
    return Json{{"verdict", rows.empty() ? "ok" : "failed"}, {"files", report.files}, {"findings", rows}};
}

}  // namespace

int main(int argc, char** argv) {
    restart_with_fitting_kernels(argv);
    cli::Command command(
        {.name = "verify",
         .summary =
             "Rechecks everything that an asset claims, or searches any files for what tells a patient.",
         .examples = {"palpate verify liver.vtkhdf --columns 64 --json liver.verify.json",
                      "palpate verify liver.vtkhdf --trusted our_lab.pub.pem",
                      "palpate verify --privacy liver.vtkhdf liver.html liver.parts/"},
         .notes =
             "An asset that cannot be read or is damaged gives exit code 3, a failed check on a readable one "
             "4.\n"
             "Positive definiteness of a dense compliance is by Cholesky in double, which takes twice its\n"
             "memory; a hierarchical one is tried on contacts. With --privacy the mechanics are left out, "
             "and\n"
             "files and folders are searched for a patient's identity, dates, people, this machine's user "
             "and\n"
             "host, and paths; a finding gives exit code 4. Of its value two characters and the length are\n"
             "told. Pixels are not looked at."});
    std::vector<std::filesystem::path> files;
    std::vector<std::filesystem::path> trusted;
    bool privacy = false;
    std::int32_t columns = certificate_columns, loads = certificate_loads;
    command.input("files", files, "asset (.vtkhdf); with --privacy any files and folders").required();
    command.flag("--privacy", privacy, "search for identity and place instead");
    command.input("--trusted", trusted,
                  "public keys (Ed25519, PEM), one of which must have signed the asset; repeat for more");
    command.option("--columns", columns, "columns of each compliance to solve again").range(1, 100000);
    command.option("--loads", loads, "random contact loads to solve again").range(1, 100000);
    return command.run(argc, argv, [&](cli::Session& session) {
        if (privacy) return verify_privacy(files, session);
        if (files.size() != 1)
            throw UsageError({"verify", fmt::format("{} files", files.size()), "one asset",
                              "verify them one by one, or search them with --privacy"});
        return verify(files.front(), trusted, columns, loads, session);
    });
}
