// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/mesh.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"
#include "tools/meshing/contract/mesh_to_contract.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/stages/mesh_result.hpp"

namespace palpate::stages {
namespace {

using namespace imaging;
using namespace meshing;

struct Body {  // NOLINT(bugprone-exception-escape): to move a Json throws nothing
    TetMesh mesh;
    std::int64_t pieces = 0;
    std::vector<ContractCheck> checks;
    std::string next_step;  // if the contract is missed
    Json result;
};

// The request's sizes by label values instead of names.
MeshSizing sizing_of(const MeshRequest& request, const LabelMap& map,
                     const std::vector<std::int32_t>& regions) {
    const std::string culprit = request.labels.string();
    MeshSizing sizing = request.sizing;
    for (const auto& [label, cell_size] : request.region_cell_sizes) {
        const RegionSize size{.region = require_label(map, label, culprit).value, .cell_size = cell_size};
        if (std::ranges::find(regions, size.region) == regions.end())
            throw UsageError({"--region-cell-size",
                              fmt::format("'{}={}' is no region of the body", label, cell_size),
                              "one of those named with --region", ""});
        sizing.regions.push_back(size);
    }
    for (const NearPlace& place : request.near) {
        NearSize near{.points = {}, .within = place.within, .cell_size = place.cell_size};
        if (place.point)
            near.points.emplace_back((*place.point)[0], (*place.point)[1], (*place.point)[2]);
        else
            near.label = require_label(map, place.label, culprit).value;
        sizing.near.push_back(near);
    }
    return sizing;
}

// The names of the regions that have a voxel on the image's border: what lies beyond was not scanned.
std::vector<std::string> regions_at_edge(const LabelMap& map, const std::vector<std::int32_t>& regions) {
    const std::vector<Label> at_edge = labels_at_image_edge(map);
    std::vector<std::string> names;
    for (const std::int32_t region : regions)
        if (const auto label = std::ranges::find(at_edge, region, &Label::value); label != at_edge.end())
            names.push_back(label->name);
    return names;
}

Body body_from_labels(const MeshRequest& request, const ProgressCallback& progress, const NoteSink& note) {
    if (request.labels.empty() || request.regions.empty())
        throw UsageError({"mesh", "nothing to mesh", "--labels with --region, or --mesh-file", ""});
    const LabelMap map = read_label_map(request.labels, note);
    std::vector<std::int32_t> values;
    for (const std::string& name : request.regions)
        values.push_back(require_label(map, name, request.labels.string()).value);
    ContractedMesh made = mesh_to_contract(map, values, sizing_of(request, map, values), request.contract,
                                           request.attempts, progress);
    if (made.attempts.size() > 1)
        for (const ContractCheck& miss : made.attempts.front().misses)
            note(fmt::format("made finer: {} was {} (expected {})", what_text(miss), value_text(miss),
                             limit_text(miss)));
    Body body;
    body.pieces = made.measures.quality.components;
    body.checks = made.checks;
    body.next_step = fmt::format(
        "after {} meshes: choose a smaller cell size, facet distance or --region-cell-size, or a contract "
        "that this body can keep",
        made.attempts.size());
    body.result = to_json(made.mesh, made.measures);
    body.result["attempts"] = to_json(made.attempts);
    body.result["at_image_edge"] = regions_at_edge(map, values);
    for (const Json& name : body.result["at_image_edge"])
        note(fmt::format("'{}' reaches the image's edge: what lies beyond it is missing",
                         name.get<std::string>()));
    body.mesh = std::move(made.mesh);
    return body;
}

// Measures against the labels if there is one for every region.
Body imported_body(const MeshRequest& request, const NoteSink& note) {
    ImportedMeshOptions options{.unit = request.unit, .frame = request.frame};
    for (const auto& [value, label] : request.region_names) options.region_names[value] = label;
    Body body;
    body.mesh = read_imported_tetrahedra(request.mesh_file, options, note);
    body.next_step = "mend the mesh where it was made, or state a contract that it can keep";
    const MeshQuality quality = measure(body.mesh);
    body.pieces = quality.components;
    body.checks = check_shape(request.contract, body.mesh, quality);
    body.result = to_json(body.mesh, quality);
    if (request.labels.empty()) return body;

    const LabelMap map = read_label_map(request.labels, note);
    adopt_labels(body.mesh, map);
    const std::set<std::int32_t> found(body.mesh.regions.begin(), body.mesh.regions.end());
    const std::vector<std::int32_t> values(found.begin(), found.end());
    if (!std::ranges::all_of(values, [&](std::int32_t value) {
            return std::ranges::find(map.names, value, &Label::value) != map.names.end();
        })) {
        note("a region of the mesh has no label: the mesh is not measured against the labels");
        body.result["fidelity"] = "not measured";
        return body;
    }
    const MeshSizing defaults;
    const MeshDomain domain = prepare_domain(map, values, defaults.smoothing, defaults.min_component_volume);
    const MeshMeasures measures =
        measure(body.mesh, domain.labels, region_surfaces(domain.labels, domain.smoothed));
    const auto fidelity = check_fidelity(request.contract, body.mesh, measures, map.grid);
    body.checks.insert(body.checks.end(), fidelity.begin(), fidelity.end());
    body.result = to_json(body.mesh, measures);
    return body;
}

}  // namespace

MadeMesh make_mesh(const MeshRequest& request, const ProgressCallback& progress, const NoteSink& note) {
    progress("read", 0);
    const bool imported = !request.mesh_file.empty();
    Body body = imported ? imported_body(request, note) : body_from_labels(request, progress, note);
    if (body.pieces > 1 && !request.allow_components)
        throw InvalidInput({(imported ? request.mesh_file : request.labels).string(),
                            fmt::format("the body has {} separate pieces", body.pieces), "1",
                            "keep the largest with 'palpate segment --keep-largest', or pass "
                            "--allow-components and hold each of them"});
    body.result["checks"] = to_json(body.checks);
    return {std::move(body.mesh), std::move(body.result),
            shortfall_of(body.checks, request.output.string(), body.next_step)};
}

}  // namespace palpate::stages
