// SPDX-License-Identifier: Apache-2.0
// The way to the equilibrium: what forces answer to a state, and which state is next; part of the tick.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double slight_step = 0.01;  // of what is to be made good
constexpr double most_steady = 2;     // times as far as in the last tick

}  // namespace

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
        each_hold(tool, [&](Hold& hold) {
            tool.next_off[iterate] += hold.next_drag[iterate] / coupling_;
            hold.drag_difference[iterate] = (hold.next_drag[iterate] - hold.drag) / coupling_;
        });
        if (tool.felt == 0) tool.off = tool.next_off[iterate];
        tool.difference[iterate] = tool.next_off[iterate] - tool.off;
        change = std::max(change, tool.difference[iterate].lpNorm<Eigen::Infinity>());
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (Touch& touch : part.touches) {
                touch.sunk_difference[iterate] = touch.next_sunk[iterate] - touch.sunk;
                change = std::max(change, touch.sunk_difference[iterate].lpNorm<Eigen::Infinity>());
            }
    }
    if (turns()) change = std::max(change, answer_turns(iterate));
    for (DeformedPatch& patch : patches_) change = std::max(change, patch.end_answer(iterate));
    return change;
}

// Begins a tick where tools and tissue come to if they go on as in the last one, by as much as devices do.
// From there the first answer of a steady hand changes nothing, and no second one need be asked for.
void ContactEquilibrium::go_on() noexcept {
    if (!is_steady()) {
        states_known_ = 0;
        return;
    }
    const std::size_t before = state_;
    state_ = before == first_state ? first_state + 1 : first_state;
    for (Tool& tool : tools_) {
        tool.next_off[state_] = tool.off;
        tool.next_off[before] = tool.touching ? Vector3d(tool.next_off[before] - tool.way) : tool.off;
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) touch.next_sunk[state_] = touch.sunk;
        each_hold(tool, [&](Hold& hold) { hold.next_drag[state_] = hold.drag; });
    }
    for (DeformedPatch& patch : patches_) patch.keep_state(state_);
    if (++states_known_ < 2) return;
    Weights weights{};
    const double steady = steadiness();
    weights[state_] = 1 + steady;
    weights[before] = -steady;
    // No farther than what is near was looked at.
    double longest = std::numeric_limits<double>::infinity(), way = std::abs(steady) * last_motion_;
    for (const Tool& tool : tools_) {
        if (!tool.touching) continue;
        longest = std::min(longest, tool.near);
        way = std::max(way, (combined(weights, tool.next_off) - tool.off).norm());
        for (const Part& part : std::span(tool.parts).first(tool.felt))
            for (const Touch& touch : part.touches)
                way = std::max(way, (combined(weights, touch.next_sunk) - touch.sunk).norm());
    }
    if (steady == 0 || way > longest) return;
    relax_to(weights, std::numeric_limits<double>::infinity());
    for (Tool& tool : tools_) tool.near *= foreseen;
}

// Whether a tick goes on from the one before it, in which the same was felt.
bool ContactEquilibrium::is_steady() const noexcept {
    const auto goes_on = [](const Tool& tool) {
        return tool.felt == tool.was_felt && !(tool.touching && tool.cold);
    };
    return !turns() && std::ranges::all_of(tools_, goes_on);
}

// By how much the devices of tools that touch go on as in the last tick.
double ContactEquilibrium::steadiness() const noexcept {
    double along = 0, squared = 0;
    for (const Tool& tool : tools_) {
        if (!tool.touching) continue;
        along += tool.way.dot(tool.last_way);
        squared += tool.last_way.squaredNorm();
    }
    return squared > 0 ? std::clamp(along / squared, -1.0, most_steady) : 0;
}

// Keeps the first answers of the tick before, if they tell anything.
void ContactEquilibrium::carry_over() noexcept {
    if (in_row_ < 2) return;
    bank_ = 1 - bank_;
    carried_ = std::exchange(in_row_, 0);
}

// Compares an answer with those that mix() may ask for.
void ContactEquilibrium::compare(std::size_t iteration) noexcept {
    const std::size_t newest = answer_of(iteration);
    const auto with = [&](std::size_t other) {
        double sum = 0;
        for (const Tool& tool : tools_) {
            sum += tool.difference[newest].dot(tool.difference[other]);
            if (turns())
                sum += tool.longest_arm * tool.longest_arm *
                       tool.turn_difference[newest].dot(tool.turn_difference[other]);
            for (const Part& part : std::span(tool.parts).first(tool.felt))
                for (const Touch& touch : part.touches)
                    sum += touch.sunk_difference[newest].dot(touch.sunk_difference[other]);
            each_hold(tool, [&](const Hold& hold) {
                sum += hold.drag_difference[newest].dot(hold.drag_difference[other]);
            });
        }
        for (const DeformedPatch& patch : patches_) sum += patch.product_of_differences(newest, other);
        const auto i = static_cast<Index>(newest), j = static_cast<Index>(other);
        products_(i, j) = products_(j, i) = sum;
    };
    for (std::size_t k = 0; k < std::min(iteration + 1, first_answers); ++k) with(answer_of(iteration - k));
    for (std::size_t k = 0; k < carried_; ++k) with(carried_answer(k));
}

// The weights, summing to 1, with which an answer and what it would be after steps like those from one answer
// to the next differ least from their states, as if answers were linear in states (Anderson 1965). Such steps
// are those between the last `known` answers of this tick, and between the first `carried` of a tick before:
// what answers depend on hardly changes from tick to tick (Degroote et al. 2009 reuse steps so).
ContactEquilibrium::Weights ContactEquilibrium::mix(std::size_t iteration, std::size_t known,
                                                    std::size_t carried) const noexcept {
    constexpr std::size_t most_steps = 2 * (first_answers - 1);
    constexpr double dependent = 1e-8;  // part of a step that is rounding
    const std::size_t newest = answer_of(iteration);
    FixedList<std::pair<std::size_t, std::size_t>, most_steps> steps;
    for (std::size_t k = 1; k < known; ++k)
        steps.push_back({answer_of(iteration - k + 1), answer_of(iteration - k)});
    for (std::size_t k = 1; k < carried; ++k) steps.push_back({carried_answer(k), carried_answer(k - 1)});
    const auto product = [&](std::size_t a, std::size_t b) {
        return products_(static_cast<Index>(a), static_cast<Index>(b));
    };
    Weights weights = alone(newest);
    if (steps.empty()) return weights;
    using Square = Eigen::Matrix<double, most_steps, most_steps>;
    Square matrix = Square::Identity();
    Eigen::Matrix<double, most_steps, 1> right = Eigen::Matrix<double, most_steps, 1>::Zero(), scale = right;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const auto [a, b] = steps[i];
        const double squared = product(a, a) - 2 * product(a, b) + product(b, b);
        const auto row = static_cast<Index>(i);
        // A step that is small beside what is to be made good says nothing about it.
        if (!(squared > slight_step * slight_step * product(newest, newest))) continue;
        scale[row] = 1 / std::sqrt(squared);
        right[row] = scale[row] * (product(a, newest) - product(b, newest));
        matrix(row, row) = 1 + dependent;
        for (std::size_t j = 0; j < i; ++j) {
            const auto [c, d] = steps[j];
            const auto column = static_cast<Index>(j);
            matrix(row, column) = matrix(column, row) =
                scale[row] * scale[column] * (product(a, c) - product(a, d) - product(b, c) + product(b, d));
        }
    }
    const Eigen::Matrix<double, most_steps, 1> parts = matrix.ldlt().solve(right).cwiseProduct(scale);
    if (!parts.allFinite()) return weights;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        weights[steps[i].first] -= parts[static_cast<Index>(i)];
        weights[steps[i].second] += parts[static_cast<Index>(i)];
    }
    return weights;
}

// Where to go on from: a combination of the answers so far, whose newest differs by `change` (mm) from the
// state that it answers.
ContactEquilibrium::Weights ContactEquilibrium::next_state(std::size_t iteration, std::size_t known,
                                                           double change) noexcept {
    const std::size_t newest = answer_of(iteration);
    Weights next = mix(iteration, known, carried_);
    // Steps of a tick before say little of where they do not lead, as where tissue is about to snap.
    double far = departure(next, newest);
    if (carried_ > 1 && far > change) {
        carried_ = 0;
        next = mix(iteration, known, 0);
        far = departure(next, newest);
    }
    if (climbs(next, newest)) {
        // To a saddle, as where a sphere rolls over an edge. What lies there across its ridge is stiff, and
        // answers to it alternate: so away from it, from the middle of two answers.
        Weights middle = alone(newest);
        if (known > 1) middle[newest] = middle[answer_of(iteration - 1)] = 0.5;
        next = between(middle, next, -std::min(1.0, farthest_ahead * change / far));
        far = departure(next, newest);
    }
    return far > farthest_ahead * change ? between(alone(newest), next, farthest_ahead * change / far) : next;
}

// How far a combination of answers is from one of them, mm.
double ContactEquilibrium::departure(const Weights& weights, std::size_t from) const noexcept {
    double most = 0;
    const auto depart = [&](const Offsets& answers) {
        return (combined(weights, answers) - answers[from]).norm();
    };
    for (const Tool& tool : tools_) {
        most = std::max(most, depart(tool.next_off));
        if (turns()) most = std::max(most, tool.longest_arm * depart(tool.next_turn));
        for (const Part& part : std::span(tool.parts).first(tool.felt))
            for (const Touch& touch : part.touches)
                if (!touch.is_far()) most = std::max(most, depart(touch.next_sunk));
        each_hold(tool, [&](const Hold& hold) { most = std::max(most, depart(hold.next_drag) / coupling_); });
    }
    for (const DeformedPatch& patch : patches_) most = std::max(most, patch.departure(weights, from));
    return most;
}

// Whether a combination of answers leads the other way than the newest answer, which leads down V.
bool ContactEquilibrium::climbs(const Weights& weights, std::size_t newest) const noexcept {
    double along = 0;
    for (const Tool& tool : tools_) {
        along += (combined(weights, tool.next_off) - tool.off).dot(tool.difference[newest]);
        if (turns())
            along += tool.longest_arm * tool.longest_arm *
                     (combined(weights, tool.next_turn) - tool.turn).dot(tool.turn_difference[newest]);
        for (const Part& part : std::span(tool.parts).first(tool.felt))
            for (const Touch& touch : part.touches)
                along += (combined(weights, touch.next_sunk) - touch.sunk).dot(touch.sunk_difference[newest]);
    }
    for (const DeformedPatch& patch : patches_) along += patch.along(weights, newest);
    return along < 0;
}

// Goes to a combination of answers, at most `longest` mm: what is farther off has not been looked at. Where
// tissue snaps, answers are to surfaces that are not there.
void ContactEquilibrium::relax_to(const Weights& weights, double longest) noexcept {
    double way = 0;
    for (const Tool& tool : tools_) {
        way = std::max(way, (combined(weights, tool.next_off) - tool.off).norm());
        if (turns())
            way = std::max(way, tool.longest_arm * (combined(weights, tool.next_turn) - tool.turn).norm());
    }
    if (walked_ahead * change_ > longest)
        for (const DeformedPatch& patch : patches_) way = std::max(way, patch.way_to(weights));
    const double step = way > longest ? longest / way : 1;
    for (Tool& tool : tools_) {
        tool.off += step * (combined(weights, tool.next_off) - tool.off);
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (Touch& touch : part.touches)
                touch.sunk += step * (combined(weights, touch.next_sunk) - touch.sunk);
        tool.drag.setZero();
        each_hold(tool, [&](Hold& hold) {
            hold.drag += step * (combined(weights, hold.next_drag) - hold.drag);
            tool.drag += hold.drag;
        });
        if (turns()) relax_turn(tool, weights, step);
    }
    for (DeformedPatch& patch : patches_) patch.relax_to(weights, step);
}

}  // namespace palpate::haptics
