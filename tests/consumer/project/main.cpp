// SPDX-License-Identifier: Apache-2.0
// A foreign program: touches the asset that it is given, and reports the culprit of one that is not there.
#include <algorithm>
#include <formats/asset/asset.hpp>
#include <formats/elasticity/plausible_compliance.hpp>
#include <formats/model/errors.hpp>
#include <iostream>
#include <runtime/haptics/haptic_model.hpp>

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const palpate::Case patient_case = palpate::asset::load_asset(argv[1]);
    for (const palpate::DeformableBody& body : patient_case.deformable_bodies)
        palpate::elasticity::require_answers_of_mesh(body, argv[1], 1);
    palpate::haptics::HapticModel model(patient_case);
    const Eigen::Vector3d middle =
        patient_case.deformable_bodies.front().obb_tree.nodes.front().center.cast<double>();
    const auto touch = [&](double above) {
        palpate::realtime::DeviceState device;
        device.position = {middle.x(), middle.y(), middle.z() + above};
        palpate::TickResult result{};
        model.tick(device, result);
        return result;
    };
    double peak = 0;
    for (double above = 40; above > 5; above -= 0.1)
        peak = std::max(peak, Eigen::Map<const Eigen::Vector3d>(touch(above).force.data()).norm());
    std::cout << peak << " N\n";
    if (!(peak > 0)) return 1;
    try {
        palpate::asset::read_asset("absent.vtkhdf");
    } catch (const palpate::InvalidInput& error) {
        std::cout << error.detail().culprit << '\n';
        return error.detail().culprit == "absent.vtkhdf" ? 0 : 1;
    }
    return 1;
}
