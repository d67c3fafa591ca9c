// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/touch_json.hpp"

#include <nlohmann/json.hpp>
#include <span>

namespace palpate::apps {

using namespace haptics;
using namespace session;

using Json = nlohmann::ordered_json;

namespace {

Json numbers(std::span<const double, 3> v) {
    return Json::array({v[0], v[1], v[2]});
}

}  // namespace

Json target_json(const TouchTarget& target, const HapticModel& model) {
    return {{"body", model.body_name(target.body)},
            {"triangle", target.triangle},
            {"point_mm", numbers(std::span<const double, 3>(target.place.point.data(), 3))},
            {"normal", numbers(std::span<const double, 3>(target.place.normal.data(), 3))},
            {"clearance_mm", target.place.clearance}};
}

Json grasp_json(const GraspPlace& place, const HapticModel& model) {
    const Eigen::Vector4d& q = place.grasp.orientation.coeffs();
    return {{"body", model.body_name(place.body)},
            {"meet_mm", numbers(std::span<const double, 3>(place.grasp.meet.data(), 3))},
            {"orientation", Json::array({q[0], q[1], q[2], q[3]})},
            {"thickness_mm", place.grasp.thickness},
            {"depth_mm", place.grasp.depth}};
}

namespace {

// The tick of the largest force, with all that is needed to compute it again from the stiffness matrix.
Json peak_json(const TickResult& peak, const Case& patient_case, const HapticModel& model) {
    // Of a deformable body, the node of the mesh; of a rigid one, the vertex.
    const auto node_of = [&](std::size_t body, std::int32_t vertex) {
        if (body < model.rigid_count()) return vertex;
        const auto& soft = patient_case.deformable_bodies[body - model.rigid_count()];
        return soft.boundary.nodes[static_cast<std::size_t>(vertex)];
    };
    Json contacts = Json::array();
    for (const Contact& contact : peak.active_contacts()) {
        const auto body = static_cast<std::size_t>(contact.body);
        Json nodes = Json::array(), weights = Json::array();
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i) {
            nodes.push_back(node_of(body, contact.vertices[i]));
            weights.push_back(contact.weights[i]);
        }
        Json other_body, other_node;
        if (is_of_neighbour(contact)) {
            const auto other = static_cast<std::size_t>(contact.other_body);
            other_body = model.body_name(other);
            other_node = node_of(other, contact.other_vertex);
        }
        contacts.push_back(
            {{"body", model.body_name(body)},
             {"nodes", nodes},
             {"weights", weights},
             {"normal", Json::array({contact.normal[0], contact.normal[1], contact.normal[2]})},
             {"gap_mm", contact.gap},
             {"force_n", contact.force},
             {"friction_n", Json::array({contact.friction[0], contact.friction[1], contact.friction[2]})},
             {"part", contact.part},
             {"other_body", other_body},
             {"other_node", other_node},
             {"series_compliance_mm_per_n", contact.series_compliance}});
    }
    return {{"t_s", peak.time},
            {"device_mm", numbers(peak.device_position)},
            {"force_n", numbers(peak.force)},
            {"torque_n_mm", numbers(peak.torque)},
            {"device_orientation", peak.orientation},
            {"tool_mm", numbers(peak.tool_position)},
            {"tool_orientation", peak.tool_orientation},
            {"depth_mm", peak.depth},
            {"coupling_stiffness_n_per_mm", model.coupling()},
            {"contacts", contacts}};
}

}  // namespace

Json tool_json(const RunRecord& record, const Case& patient_case, const HapticModel& model) {
    return {{"force_peak_n", record.peak_force()},
            {"torque_peak_n_mm", record.peak_torque()},
            {"force_step_max_n", record.largest_force_step()},
            {"penetration", {{"device_mm", record.device_depth()}, {"tool_mm", record.tool_depth()}}},
            {"statuses", record.statuses().by_name()},
            {"peak", peak_json(record.peak(), patient_case, model)}};
}

Json replay_json(const ReplayOutcome& outcome) {
    Json json{{"ticks", outcome.ticks},
              {"different_ticks", outcome.different_ticks},
              {"first_difference", nullptr},
              {"largest_difference_n", outcome.largest_difference},
              {"largest_difference_n_mm", outcome.largest_torque_difference},
              {"started_at_tick", nullptr},
              {"missing_ticks", outcome.missing_ticks},
              {"skipped_ticks", outcome.skipped_ticks}};
    if (outcome.started) json["started_at_tick"] = *outcome.started;
    if (const auto& first = outcome.first_difference)
        json["first_difference"] = {{"tick", first->tick},
                                    {"tool", first->tool},
                                    {"recorded_n", numbers(first->recorded)},
                                    {"replayed_n", numbers(first->replayed)},
                                    {"recorded_n_mm", numbers(first->recorded_torque)},
                                    {"replayed_n_mm", numbers(first->replayed_torque)}};
    return json;
}

}  // namespace palpate::apps
