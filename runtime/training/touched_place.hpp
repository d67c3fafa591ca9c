// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"

namespace palpate::training {

/// Which place of the patient a tick's tool touches, whatever it has been displaced by: the mean of its
/// contact points on the rest surfaces, weighted by their forces, p_P, mm. Nothing without contact.
std::optional<Eigen::Vector3d> touched_place(const Case& patient_case, const TickResult& tick);

}  // namespace palpate::training
