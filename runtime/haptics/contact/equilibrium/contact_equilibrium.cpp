// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

// Contact that keeps energy. A tool of spheres of radius r hangs on its virtual coupling of stiffness K from
// the device at d; x is where it is, u the displacements of the bodies' surfaces, C their compliance against
// loads spread over the surface (load_shares.cpp). A sphere pressed into tissue sinks in by s besides,
// against a potential U (local_indentation.cpp): what meets the surface is y = x + s, and it meets vertices
// that do not give way at all, which are not sunk into, s farther on. All come to rest where
//     V = 1/2 K |x - d|² + 1/2 u . C^-1 u + U(s)    is least under    g_t = |y - q_t(u, s)| - r - rho_t >= 0
// for every sphere and every triangle t of the surface as it is *displaced*. Its edges are round: at each
// corner a ball lies inside the surface and goes with it (inner_balls.cpp), and q_t and rho_t are centre and
// radius of the ball nearest to y of those between them.
// The force on the device is -dV/dd = K (x - d): its work round a closed loop is zero. Rest positions,
// anchors and smoothed normals have no part in it. A tool that turns by itself, by the rotation vector theta
// from its device's orientation, adds 1/2 kappa |theta|² and has its spheres at x + exp(theta) r; to A that
// adds l_k . l_l / kappa with the levers l = (exp(theta) r) x n, and the torque on the device is kappa theta.
//
// g_t is differentiable wherever y is off the balls' centres: its gradient by x is n = (y - q_t) / |y - q_t|,
// -w_i n by u_i, w the barycentric weights of q_t, and p n by s, p the sum of w over the vertices that give
// way. So s answers to the press F = sum p f n (equilibrium_sinking.cpp has more). Linearised at the present
// state, with s = s_0 + S F about the present F, the conditions for the forces f >= 0 that the triangles
// press with are
//     A f - delta >= 0,    f >= 0,    f . (A f - delta) = 0,
//     A_kl = n_k . n_l / K + sum_ij w_ki w_lj n_k . C_ij n_l + p_k p_l n_k . S_kl n_l,
//     delta_k = n_k . (x - d + p_k (s - s_0)) - sum_i w_ki n_k . u_i - g_k.
// The first term of A is there where k and l are of one tool, the second where they lie on one body, the
// third where they press one sphere, or several of one tool that sink each other in; a rigid body has the
// first alone. Where bodies press each other (neighbour_contact.cpp), there are rows of the second kind
// between them. Where tissue creeps, C and s are what they come to within a tick, and what earlier forces
// left behind counts as if it were held: so V is another in each tick, and a closed way loses energy
// (deformed_patch_creep.cpp, remember_pushes()). The forces answer with the next x = d + sum f n / K, u = -C
// sum w n f and s, and so on until nothing changes. Answers are combined as Anderson (1965) has it, for two
// sets of contacts would take turns for ever, with steps between answers of the tick before besides: so two
// answers do in most ticks, and one where a hand is steady, for the search begins where going on as in the
// tick before would lead. Friction is part of state and answer.

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int warm_iterations = 8, cold_iterations = 24;
// Where warm iterations do not settle, as where tissue is about to snap, a tick has some to spare: with few
// rows, or while it is far from settled.
constexpr int spare_iterations = 32;
constexpr std::size_t few_rows = 16;
// Squares of the numbers of rows, summed over the iterations of a search, that a tick can afford: about a
// millisecond for what is to spare, three for a search that starts anew with very many rows. It makes a few
// iterations nevertheless, or it would say nothing.
constexpr std::size_t spare_spent = 20'000, most_spent = 60'000;
constexpr int least_iterations = 2;
constexpr double far_off = 10;  // times the change before it
constexpr double helped = 0.5;  // times the change before it

}  // namespace

void ContactEquilibrium::reset() noexcept {
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) {
                touch.forget_pushes();
                touch.way = -1;
            }
    for (DeformedPatch& patch : patches_) patch.reset();
    for (std::size_t t = 0; t < tools_.size(); ++t) forget(t);
    neighbours_.forget();
    forget_tissue();
}

void ContactEquilibrium::forget(std::size_t t) noexcept {
    tools_[t].walled = false;
    leave_tissue(t);
    for (Part& part : tools_[t].parts) {
        for (Hold& hold : part.holds) hold.press = 0;
        Hold& of_walls = part.holds.back();
        of_walls.slip.setZero();
        of_walls.slid = of_walls.pressed = false;
    }
}

// Lets go of the tissue, but not of walls: what they hold stays as it is turned.
void ContactEquilibrium::leave_tissue(std::size_t t) noexcept {
    Tool& tool = tools_[t];
    bank_ = in_row_ = carried_ = states_known_ = 0;
    tool.touching = tool.at_rest = false;
    tool.off.setZero();
    if (!tool.walled) tool.turn.setZero();
    tool.unpressed_turn = tool.kept_turn;
    if (turns()) swing(tool);
    tool.press.setZero();
    tool.drag.setZero();
    for (Part& part : tool.parts) {
        for (Hold& hold : part.holds) hold.drag.setZero();
        for (std::size_t soft = 0; soft < patches_.size(); ++soft) {
            Touch& touch = part.touches[soft];
            Hold& hold = part.holds[soft];
            touch.near.clear();
            touch.gathered_in = -1;
            touch.sunk = local_dent(part.radius, touch, patches_[soft]);
            touch.push.setZero();
            touch.shared.setZero();
            touch.righting = 0;
            touch.outside = false;
            hold.slip.setZero();
            hold.slid = hold.pressed = false;
        }
    }
}

void ContactEquilibrium::begin_tick(double stiffness, double torsion) noexcept {
    coupling_ = stiffness;
    torsion_ = torsion;
    resists_turning_ = false;
    spare_iterations_ = spare_iterations;
    if (std::exchange(begins_, true)) states_known_ = 0;
    rows_.clear();
    forget_groups();
    residual_ = change_ = 0;
    for (Tool& tool : tools_) {
        tool.was_felt = std::exchange(tool.felt, 0);
        tool.outside = true;
        tool.at_rest = false;
        tool.unpressed_turn -= tool.kept_turn;
        tool.kept_turn.setZero();
        if (friction_.any())
            for (Part& part : tool.parts) {
                for (Hold& hold : part.holds) hold.press = 0;
                // What slid on a wall may be held in this tick.
                part.holds.back().slides = false;
                part.holds.back().slipping = 0;
            }
    }
    for (DeformedPatch& patch : patches_) patch.begin_tick();
    // What tissue has forgotten, spheres forget too.
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (std::size_t soft = 0; soft < patches_.size(); ++soft)
                if (patches_[soft].is_at_rest()) part.touches[soft].forget_pushes();
    neighbours_.look(patches_);
}

void ContactEquilibrium::pull(std::size_t t, const Vector3d& tip, const Eigen::Matrix3d& orientation,
                              std::span<const Sphere> spheres) noexcept {
    Tool& tool = tools_[t];
    tool.on_device = orientation;
    tool.last_device_tip = std::exchange(tool.tip, tip);
    tool.last_way = std::exchange(tool.way, tip - tool.last_device_tip);
    double moved = 0;
    bool meets = false;
    for (std::size_t p = 0; p < spheres.size(); ++p) {
        Part& part = tool.parts[p];
        part.last_device = part.sphere.device;
        if (p < tool.was_felt) moved = std::max(moved, (spheres[p].device - part.last_device).norm());
        part.sphere = spheres[p];
        for (const GodObject::Touch& touch : spheres[p].if_rigid->touches())
            meets = meets || touch.surface >= bodies_.rigid_count();
        meets = meets || spheres[p].kept_by_tissue;
        // Clear of a body as it is at rest, a sphere will meet it elsewhere.
        for (std::size_t soft = 0; soft < patches_.size(); ++soft)
            if (part.touches[soft].push == Vector3d::Zero() &&
                std::ranges::none_of(spheres[p].if_rigid->touches(), [&](const GodObject::Touch& touch) {
                    return touch.surface == bodies_.rigid_count() + soft;
                }))
                part.touches[soft].forget_pushes();
    }
    tool.felt = spheres.size();
    tool.cold = !tool.touching;
    tool.touching = tool.touching || meets;
    tool.reach = tool.cold ? cold_reach : first_reach + 2 * moved;
    tool.near = tool.farthest_near = tool.cold ? first_reach : 2 * moved;
    tool.held_reach = tool.cold && !turns() ? 0 : (tool.last_tip - tool.last_device_tip).norm() + moved;
    const bool begins = tool.cold && (meets || !tool.walled);
    tool.off = begins ? Vector3d::Zero() : Vector3d(tool.last_tip - tip);
    if (begins) tool.turn.setZero();
    if (turns()) pull_arms(tool);
}

bool ContactEquilibrium::walls_are_full() const noexcept {
    return wall_count() == most_walls;
}

void ContactEquilibrium::add_wall(std::size_t tool, Contact& contact) noexcept {
    const std::size_t walls = wall_count();
    assert(walls < most_walls);
    Row row;
    row.tool = static_cast<std::int32_t>(tool);
    row.part = contact.part;
    row.triangle = contact.triangle;
    row.normal = normal_of(contact);
    row.gap = static_cast<double>(contact.gap);
    row.wall = &contact;
    rows_.cut(walls);
    rows_.push_back(row);
    forget_groups();
    // Those of one sphere lie together.
    const auto of_sphere = [&](const Row& other) { return other.tool == row.tool && other.part == row.part; };
    const auto behind = std::find_if(std::make_reverse_iterator(rows_.end() - 1),
                                     std::make_reverse_iterator(rows_.begin()), of_sphere)
                            .base();
    if (behind != rows_.begin()) std::rotate(behind, rows_.end() - 1, rows_.end());
}

void ContactEquilibrium::drop_walls(std::size_t t) noexcept {
    rows_.erase_if(
        [&](const Row& row) { return row.wall != nullptr && row.tool == static_cast<std::int32_t>(t); });
    forget_groups();
}

std::size_t ContactEquilibrium::drop_idle_walls(std::size_t t, std::span<Contact> contacts) noexcept {
    std::array<Contact, most_walls> pressing;
    std::size_t kept = 0;
    rows_.erase_if([&](Row& row) {
        if (row.wall == nullptr || row.tool != static_cast<std::int32_t>(t)) return false;
        if (!(row.force > 0)) return true;
        pressing[kept] = *row.wall;
        row.wall = &contacts[kept++];
        return false;
    });
    std::copy_n(pressing.begin(), kept, contacts.begin());
    forget_groups();
    return kept;
}

// Rows lie elsewhere from now on.
void ContactEquilibrium::forget_groups() noexcept {
    groups_.clear();
    wall_groups_.clear();
    rubbing_.clear();
}

std::size_t ContactEquilibrium::wall_count() const noexcept {
    const auto is_wall = [](const Row& row) { return row.wall != nullptr; };
    return static_cast<std::size_t>(std::partition_point(rows_.begin(), rows_.end(), is_wall) -
                                    rows_.begin());
}

void ContactEquilibrium::solve() noexcept {
    if (std::exchange(begins_, false))
        go_on();
    else
        look_widely();
    carry_over();
    const auto starts = [](const Tool& tool) { return tool.felt > 0 && tool.touching && tool.cold; };
    iterate(std::ranges::any_of(tools_, starts) ? cold_iterations : warm_iterations);
    if (turns() && !resists_turning_ && turn_change_ > unsettled) {
        resist_turning();
        iterate(warm_iterations);
    }
    // What was found from the last tick on may have led astray: then contact starts anew. And where that does
    // not lead to an equilibrium either, the surface at rest has to do.
    look_widely();
    if (start_anew()) iterate(cold_iterations);
    if (start_anew()) {
        for (std::size_t t = 0; t < tools_.size(); ++t) tools_[t].at_rest = tools_[t].cold && !found(t);
        iterate(warm_iterations);
    }
}

// Solves whatever may press a tool, foreseen or not.
void ContactEquilibrium::look_widely() noexcept {
    for (Tool& tool : tools_) tool.near = tool.farthest_near;
}

// Lets the tools start anew that are not in equilibrium; false if there are none.
bool ContactEquilibrium::start_anew() noexcept {
    bool any = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        if (tool.felt == 0 || !tool.touching || found(t)) continue;
        any = true;
        const bool at_rest = tool.at_rest;
        tool.walled = false;
        leave_tissue(t);
        tool.touching = tool.cold = true;
        tool.at_rest = at_rest;
    }
    return any;
}

void ContactEquilibrium::iterate(int most) noexcept {
    std::size_t known = 0;
    double before = std::numeric_limits<double>::infinity();
    std::size_t spent = 0;
    const auto may_go_on = [&](int iteration) {
        const std::size_t rows = rows_.size() + neighbours_.row_count() + tangents_.size();
        // What friction on tissue alone takes, a second one, is no more than usual.
        if (iteration > 0) spent += rows * rows * std::max<std::size_t>(solves_, 2) / 2;
        if (iteration >= least_iterations && spent > most_spent) return false;
        return iteration < most ||
               ((rows <= few_rows || change_ > unsettled) && spent <= spare_spent && spare_iterations_-- > 0);
    };
    for (int iteration = 0; may_go_on(iteration); ++iteration) {
        rows_.cut(wall_count());
        watched_.clear();
        double longest = cold_reach;
        bool predicts = false;
        ++round_;
        if (iteration == foreseen_rounds) look_widely();
        may_change_grip_ = iteration < grip_rounds;
        for (DeformedPatch& patch : patches_) patch.measure_step();
        for (std::size_t t = 0; t < tools_.size(); ++t) {
            Tool& tool = tools_[t];
            if (tool.felt == 0) continue;
            tool.outside = true;
            tool.cut = false;
            const bool starts = tool.touching && tool.cold && (iteration == 0 || tool.at_rest);
            for (std::size_t p = 0; p < tool.felt; ++p) {
                if (starts) gather_at_rest(t, p);
                for (std::size_t soft = 0; !starts && soft < patches_.size(); ++soft) {
                    if (!tool.touching && !patches_[soft].bears_force()) continue;
                    if (iteration == (tool.touching && tool.cold ? 1 : 0)) look_around(t, p, soft);
                    tool.outside = gather(t, p, soft) && tool.outside;
                }
            }
            predicts = predicts || starts;
            longest = std::min(longest, tool.reach);
        }
        cut_rows();
        neighbours_.gather(patches_, max_contacts - rows_.size());
        group_rows();
        solve_rows();
        const auto round = static_cast<std::size_t>(iteration);
        const std::size_t newest = answer_of(round);
        if (friction_.any())
            rub(newest);
        else
            for (DeformedPatch& patch : patches_) patch.keep_hold(newest);
        const double change = change_ = answer(newest);
        compare(round);
        // Where answers of a tick before have led astray, it goes on from what they were added to.
        if (known > 0 && carried_ > 1 && change > before) {
            carried_ = known = 0;
            neighbours_.move(change);
            relax_to(alone(answer_of(round - 1)), longest);
            continue;
        }
        if (known > 1 && change > helped * before) carried_ = 0;
        // An answer from far off says little about the next one, and one to surfaces at rest nothing.
        known = change > far_off * before ? 1 : std::min(known + 1, first_answers);
        if (predicts) known = 0;
        if (known == round + 1) in_row_ = known;
        before = change;
        neighbours_.move(change);
        const Weights next = change < settled ? alone(newest) : next_state(round, known, change);
        relax_to(next, predicts ? std::numeric_limits<double>::infinity() : longest);
        if (change < settled && watched_are_clear() && neighbours_.is_clear(patches_)) break;
    }
}

// A tool that nothing presses is clear of the tissue on which it would rest if nothing gave way, or other
// tools have moved that out of its way. Otherwise it has gone through.
bool ContactEquilibrium::found(std::size_t t) const noexcept {
    const Tool& tool = tools_[t];
    if (!tool.outside || tool.press != Vector3d::Zero()) return tool.outside;
    for (const Part& part : std::span(tool.parts).first(tool.felt)) {
        if (part.sphere.kept_by_tissue) return false;
        for (const GodObject::Touch& touch : part.sphere.if_rigid->touches()) {
            if (touch.surface < bodies_.rigid_count()) continue;
            const std::size_t soft = touch.surface - bodies_.rigid_count();
            const Vector3d dent = local_dent(part.radius, part.touches[soft], patches_[soft]);
            const TriangleCorners corners = patches_[soft].look_at(touch.foot.triangle, dent);
            Vector3d foot = -dent;
            for (std::size_t i = 0; i < 3; ++i)
                foot += touch.foot.barycentric[static_cast<Index>(i)] * corners[i];
            const double reach = first_reach + patches_[soft].body().cut_off(touch.foot);
            if (touch.normal.dot(foot - part.sphere.device) + part.radius > reach) return false;
        }
    }
    return true;
}

// Its part in the drag of its sphere, N.
std::array<float, 3> ContactEquilibrium::friction_of(const Row& row) const noexcept {
    const Hold& hold = hold_of(row);
    if (!(hold.press > 0)) return {0, 0, 0};
    const Vector3f drag = (row.force / hold.press * hold.drag).cast<float>();
    return {drag.x(), drag.y(), drag.z()};
}

void ContactEquilibrium::write_contacts(std::size_t t, TickResult& result) const noexcept {
    for (const Row& row : rows_) {
        if (row.tool != static_cast<std::int32_t>(t)) continue;
        if (row.wall) {
            row.wall->force = static_cast<float>(row.force);
            row.wall->gap = static_cast<float>(gap_of_wall(row));
            if (turns()) row.wall->friction = friction_of(row);
            continue;
        }
        const auto used = static_cast<std::size_t>(result.contact_count);
        if (!(row.force > 0) || used == max_contacts) continue;
        const DeformableContact& body = patch_of(row).body();
        Contact contact;
        contact.body = body.body_index();
        contact.part = row.part;
        contact.triangle = row.triangle;
        contact.vertices = body.triangle(row.triangle);
        Eigen::Map<Vector3f>(contact.weights.data()) = row.weights.cast<float>();
        Eigen::Map<Vector3f>(contact.normal.data()) = row.normal.cast<float>();
        const Touch& touch = touch_of(row);
        const double sunk =
            row.part_giving_way * row.normal.dot(touch.sunk_free + touch.sinking * touch.push + touch.shared);
        contact.gap = static_cast<float>(row.gap + row.part_giving_way * row.normal.dot(touch.sunk_free));
        contact.force = static_cast<float>(row.force);
        contact.series_compliance = static_cast<float>(sunk / row.force);
        contact.friction = friction_of(row);
        result.contacts[used] = contact;
        ++result.contact_count;
    }
}

void ContactEquilibrium::end_tick() noexcept {
    bool any = false;
    for (Tool& tool : tools_) {
        tool.turn_before = tool.felt > 0 ? tool.turn : Vector3d::Zero();
        if (turns()) tool.last_tip = tool.tip + (tool.felt > 0 ? tool.off : Vector3d::Zero());
        tool.last_R_PT = tool.R_PT;
        tool.walled = false;
    }
    if (turns())
        for (const Row& row : rows_)
            if (Tool& tool = tools_[static_cast<std::size_t>(row.tool)];
                row.wall != nullptr && row.force > 0 && !tool.press.isZero(0))
                tool.walled = true;
    last_motion_ = 0;
    for (const DeformedPatch& patch : patches_) last_motion_ = std::max(last_motion_, patch.motion());
    remember_pushes();
    neighbours_.end_tick(patches_);
    if (friction_.any()) keep_hold_of_walls();
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        const bool pressed = std::ranges::any_of(rows_, [&](const Row& row) {
            return row.tool == static_cast<std::int32_t>(t) && row.patch >= 0 && row.force > 0;
        });
        if (pressed && tool.felt > 0 && !tool.at_rest && found(t)) {
            any = tool.touching = true;
            tool.last_tip = tool.tip + tool.off;
            for (std::size_t p = 0; p < tool.parts.size(); ++p)
                for (Touch& touch : tool.parts[p].touches) {
                    touch.outside = p < tool.felt;
                    touch.outside_centre = centre_of(tool, tool.parts[p], touch);
                    touch.outside_sunk = touch.sunk;
                }
        } else if (tool.touching) {
            leave_tissue(t);
        }
    }
    if (any) {
        if (friction_.any()) keep_hold_of_tissue();
    } else {
        forget_tissue();
    }
}

// Where nothing is touched, nothing that was leaves a trace in what will be, but for dents.
void ContactEquilibrium::forget_tissue() noexcept {
    bool any = false;
    for (DeformedPatch& patch : patches_) {
        if (patch.is_at_rest()) continue;
        any = true;
        patch.release();
    }
    // A sphere may have looked around in vain.
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) {
                touch.way = -1;
                touch.near.clear();
                touch.gathered_in = -1;
            }
    if (any) neighbours_.forget();
    active_count_ = bank_ = in_row_ = carried_ = states_known_ = 0;
    state_ = first_state;
    last_motion_ = 0;
}

}  // namespace palpate::haptics
