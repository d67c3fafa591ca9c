// SPDX-License-Identifier: Apache-2.0
// The way to the equilibrium: what forces answer to a state, and which state is next; part of the tick.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"
#include "runtime/haptics/contact/local_indentation.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double largest_weight = 5;  // of one answer in a combination of several

}  // namespace

// How far the present forces sink each sphere into each body; returns by how much that is off what they
// should, mm.
double ContactEquilibrium::sink(std::size_t iterate) noexcept {
    double change = 0;
    for (Tool& tool : tools_)
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (std::size_t soft = 0; soft < patches_.size(); ++soft) {
                Touch& touch = part.touches[soft];
                touch.push.setZero();
                touch.next_sunk[iterate] = local_dent(touch, patches_[soft]);
            }
    for (const Group& group : groups_) {
        Touch& touch = touch_of(group);
        const DeformableContact& body = patch_of(group).body();
        const LoadSpread* spread = body.spread();
        if (!spread) continue;
        double free = 0, press = 0;
        for (const Row& row : rows_of(group)) {
            touch.push += row.force * row.normal;
            press += row.force;
            for (std::size_t i = 0; i < 3; ++i)
                free += row.force * row.weights[static_cast<Index>(i)] *
                        spread->freedom(body.triangle(row.triangle)[i]);
        }
        const double pushing = touch.push.norm();
        if (!(press > 0) || !(pushing > 0)) continue;
        touch.freedom = free / press;
        touch.next_sunk[iterate] = touch.sunk_free + touch.sinking * touch.push;
        const double now = touch.creep != nullptr ? touch.creep->now : 1;
        const Vector3d push = now * touch.push + touch.lasting_push;
        const double along = push.norm();
        if (!(along > 0)) continue;
        const LocalIndentation local =
            local_indentation(along, radius_, spread->contact_modulus(), spread->radius());
        const Vector3d wanted = touch.freedom * local.depth / along * push;
        change = std::max(change, (wanted - touch.next_sunk[iterate]).lpNorm<Eigen::Infinity>());
    }
    return change;
}

// What the present forces make of tools and tissue; returns by how much that differs from where they are, mm.
double ContactEquilibrium::answer(std::size_t iterate) noexcept {
    for (Tool& tool : tools_) tool.next_off[iterate].setZero();
    for (DeformedPatch& patch : patches_) patch.begin_answer(iterate);
    for (const Row& row : rows_) {
        if (!(row.force > 0)) continue;
        const Vector3d push = row.force * row.normal;
        tools_[static_cast<std::size_t>(row.tool)].next_off[iterate] += push / coupling_;
        if (row.patch < 0) continue;
        DeformedPatch& patch = patch_of(row);
        for (std::size_t i = 0; i < 3; ++i)
            if (const double weight = row.weights[static_cast<Index>(i)]; weight > 0)
                patch.load_answer(iterate, row.slots[i], -weight * push);
    }
    neighbours_.load_answer(patches_, iterate);
    double change = sink(iterate);
    for (Tool& tool : tools_) {
        tool.press = coupling_ * tool.next_off[iterate];
        tool.next_off[iterate] += tool.drag / coupling_;
        if (tool.felt == 0) tool.off = tool.next_off[iterate];
        tool.difference[iterate] = tool.next_off[iterate] - tool.off;
        change = std::max(change, tool.difference[iterate].lpNorm<Eigen::Infinity>());
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (Touch& touch : part.touches) {
                touch.sunk_difference[iterate] = touch.next_sunk[iterate] - touch.sunk;
                change = std::max(change, touch.sunk_difference[iterate].lpNorm<Eigen::Infinity>());
            }
    }
    for (DeformedPatch& patch : patches_) change = std::max(change, patch.end_answer(iterate));
    return change;
}

// The weights, summing to 1, with which the last `known` answers differ least from their states, as if
// answers were linear in states (Anderson 1965).
ContactEquilibrium::Weights ContactEquilibrium::mix(std::size_t newest, std::size_t known) const noexcept {
    constexpr std::size_t all = DeformedPatch::iterates;
    Weights weights{};
    weights[newest] = 1;
    if (known < 2) return weights;
    Eigen::Matrix<double, all, all> products = Eigen::Matrix<double, all, all>::Identity();
    Eigen::Matrix<double, all, 1> ones = Eigen::Matrix<double, all, 1>::Zero();
    for (std::size_t a = 0; a < known; ++a)
        for (std::size_t b = 0; b <= a; ++b) {
            const std::size_t i = (newest + all - a) % all, j = (newest + all - b) % all;
            double sum = 0;
            for (const Tool& tool : tools_) {
                sum += tool.difference[i].dot(tool.difference[j]);
                for (const Part& part : std::span(tool.parts).first(tool.felt))
                    for (const Touch& touch : part.touches)
                        sum += touch.sunk_difference[i].dot(touch.sunk_difference[j]);
            }
            for (const DeformedPatch& patch : patches_) sum += patch.product_of_differences(i, j);
            products(static_cast<Index>(a), static_cast<Index>(b)) =
                products(static_cast<Index>(b), static_cast<Index>(a)) = sum;
        }
    const auto n = static_cast<Index>(known);
    const double scale = products.topLeftCorner(n, n).trace();
    if (!(scale > 0)) return weights;
    products.topLeftCorner(n, n) /= scale;
    for (Index k = 0; k < n; ++k) {
        products(k, k) += 1e-10;
        ones[k] = 1;
    }
    const Eigen::Matrix<double, all, 1> solution = products.ldlt().solve(ones);
    const double sum = solution.head(n).sum();
    if (!(std::abs(sum) > 0) || !solution.allFinite()) return weights;
    for (std::size_t a = 0; a < known; ++a) {
        const double weight = solution[static_cast<Index>(a)] / sum;
        if (std::abs(weight) > largest_weight) {
            weights = {};
            weights[newest] = 1;
            return weights;
        }
        weights[(newest + all - a) % all] = weight;
    }
    return weights;
}

// Goes to a combination of answers, at most `longest` mm.
void ContactEquilibrium::relax_to(const Weights& weights, double longest) noexcept {
    const auto combined = [&](const Offsets& answers) {
        Vector3d to = Vector3d::Zero();
        for (std::size_t k = 0; k < weights.size(); ++k)
            if (weights[k] != 0) to += weights[k] * answers[k];
        return to;
    };
    double way = 0;
    for (const Tool& tool : tools_) way = std::max(way, (combined(tool.next_off) - tool.off).norm());
    const double step = way > longest ? longest / way : 1;
    for (Tool& tool : tools_) {
        tool.off += step * (combined(tool.next_off) - tool.off);
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (Touch& touch : part.touches) touch.sunk += step * (combined(touch.next_sunk) - touch.sunk);
    }
    for (DeformedPatch& patch : patches_) patch.relax_to(weights, step);
}

}  // namespace palpate::haptics
