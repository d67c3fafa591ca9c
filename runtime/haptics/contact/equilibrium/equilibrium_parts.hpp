// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/creep.hpp"
#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"
#include "runtime/haptics/contact/fixed_list.hpp"
#include "runtime/haptics/contact/god_object.hpp"

namespace palpate::haptics {

/// What the search for an equilibrium works on: tools and their spheres, what of tissue and walls is near
/// them, the rows of its complementarity problem, and friction. Plain values of ContactEquilibrium.
struct EquilibriumParts {
    static constexpr std::size_t most_rows = 512;  // before they are cut
    static constexpr std::size_t most_near = 256;  // triangles beside a sphere

    /// A sphere of a tool in one tick.
    struct Sphere {
        Eigen::Vector3d device = Eigen::Vector3d::Zero();  ///< where the coupling pulls its centre, p_P, mm
        const GodObject* if_rigid = nullptr;  ///< where it rests if nothing gives way; rigid bodies first
        bool kept_by_tissue =
            false;  ///< there by tissue, whatever it touches: rigid bodies alone let it nearer
    };

    // Of the answers to states: the first ones of a tick, of this one and of one before it, and later ones.
    // After them the states in which this tick and the one before it began.
    static constexpr std::size_t first_answers = 3, first_state = 3 * first_answers;
    static_assert(DeformedPatch::iterates == first_state + 2);
    using Weights = std::array<double, DeformedPatch::iterates>;
    using Offsets = std::array<Eigen::Vector3d, DeformedPatch::iterates>;
    static Offsets no_offsets() noexcept {
        Offsets offsets;
        offsets.fill(Eigen::Vector3d::Zero());
        return offsets;
    }
    struct Row {
        std::int32_t tool = 0, part = 0;
        std::int32_t patch = -1;  // -1: of a rigid body
        std::int32_t triangle = -1;
        std::array<std::int32_t, 3> slots{};
        Eigen::Vector3d weights = Eigen::Vector3d::Zero();
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double radius = 0;    // of the sphere and of the ball that it meets, mm
        double distance = 0;  // between their surfaces, mm
        double gap = 0;       // that forces must open, mm
        // How much of its point gives way: so much of what its sphere sinks in counts here. And the square of
        // that part's slope along face or edge, 1/mm².
        double part_giving_way = 1, slope_squared = 0;
        double force = 0;                  // N
        std::int32_t place = 0, rank = 0;  // among all rows; by distance among its sphere's, then its tool's
        Contact* wall = nullptr;
    };
    // The rows of one sphere on one body, or on all rigid ones: rows_[first] ... rows_[end - 1].
    struct Group {
        std::int32_t tool = 0, part = 0, patch = 0;
        std::size_t first = 0, end = 0;
    };
    struct Bearing {
        std::int32_t slot = 0;
        double share = 0;  // of the press
    };
    using Bearings = FixedList<Bearing, 3 * max_contacts>;
    // Friction of one group of rows: what bears it, the drag (N), and whether that is solved with all others;
    // or was, and let go since nothing pressed any more.
    struct Rubbing {
        const Group* group = nullptr;
        Bearings bearings;
        Eigen::Vector3d drag = Eigen::Vector3d::Zero();
        bool held = false, let_go = false;
        int regrips = 0;
    };
    // A direction along which it is held, and by how much it gives way there, mm/N.
    struct Tangent {
        Rubbing* rubbing = nullptr;
        Eigen::Vector3d along = Eigen::Vector3d::Zero();
        double gives = 0;
    };
    struct Surrounding {
        std::int32_t tree_slot = 0, triangle = 0;
        double due = 0;  // mm of the way
    };
    // A triangle near a sphere: it is clear of it until sphere and tissue have gone so far, mm of
    // `gathered_way`.
    struct Near {
        std::int32_t triangle = 0, rounds = 0;  // since it was looked at
        double clear = std::numeric_limits<double>::lowest();
    };
    // One sphere of a tool on one body.
    struct Touch {
        FixedList<Near, most_near> near;  // when it was looked last
        // What sphere and tissue went from round to round of the search, mm; where they were in the last one.
        double gathered_way = 0;
        Eigen::Vector3d gathered_centre = Eigen::Vector3d::Zero(), gathered_sunk = Eigen::Vector3d::Zero();
        std::int64_t gathered_in = -1;  // that round
        double walked_until = 0;        // mm of `gathered_way` for which the last walk has found all
        // How far the sphere sinks into what gives way beyond what the surface does, against the press there;
        // and the press (N) about which that is linearised: sunk_free + sinking * press.
        Eigen::Vector3d sunk = Eigen::Vector3d::Zero(), push = Eigen::Vector3d::Zero();
        Offsets next_sunk = no_offsets(), sunk_difference = no_offsets();
        Eigen::Vector3d sunk_free = Eigen::Vector3d::Zero();
        Eigen::Matrix3d sinking = Eigen::Matrix3d::Zero();
        double righting = 0;                               // R of equilibrium_sinking.cpp, N/mm
        Eigen::Vector3d shared = Eigen::Vector3d::Zero();  // of sunk what its tool's other spheres do
        // Where that creeps: as what, and what is left of earlier presses; and what of that lasts, N.
        const TickCreep* creep = nullptr;
        CreepHistory left_push;
        Eigen::Vector3d lasting_push = Eigen::Vector3d::Zero();
        // What else is around, looked at again once the ways that sphere and tissue went could make it near.
        FixedList<Surrounding, most_rows> around;
        Eigen::Vector3d looked_from = Eigen::Vector3d::Zero(), looked_to = Eigen::Vector3d::Zero();
        Eigen::Vector3d looked_sunk = Eigen::Vector3d::Zero(), last_sunk = Eigen::Vector3d::Zero();
        double way = -1;  // mm, that sphere and tissue went since; negative: nothing was looked at
        Eigen::Vector3d last_centre = Eigen::Vector3d::Zero();
        // Whether it was outside at the end of the last tick, and where.
        bool outside = false;
        Eigen::Vector3d outside_centre = Eigen::Vector3d::Zero(), outside_sunk = Eigen::Vector3d::Zero();

        // From all triangles: only what presses other spheres sinks it in.
        bool is_far() const noexcept { return near.empty() && push.isZero(0) && !shared.isZero(0); }
        void forget_pushes() noexcept {
            if (creep == nullptr) return;
            creep = nullptr;
            left_push = {};
            lasting_push.setZero();
            sunk.setZero();
            righting = 0;
        }
    };
    // Friction of one sphere on one body, or on all rigid ones. It holds until more than it can is asked for,
    // and what could not be held in one tick is made good in the next.
    struct Hold {
        Eigen::Vector3d drag = Eigen::Vector3d::Zero();  // on the tool, N; and as answers have it
        Offsets next_drag = no_offsets(), drag_difference = no_offsets();
        Eigen::Vector3d slip = Eigen::Vector3d::Zero();  // mm, that the drag stands for, after the last tick,
        double sheared = 0;                              // at so many mm/N
        bool slides = false, slid = false, pressed = false;  // now; before, or in the last tick
        double slipping = 0;  // mm: how far past a wall, against the drag, where it slides
        double press = 0;     // N, all rows together
        Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // of the press
        // Where the point of the sphere was that rubbed at the end of the last tick, and from the sphere's
        // centre to it, as the tool's frame has it.
        Eigen::Vector3d rubbed_at = Eigen::Vector3d::Zero(), rubbed_arm = Eigen::Vector3d::Zero();
    };
    struct Part {
        double radius = 0;  // mm
        Sphere sphere;
        Eigen::Vector3d last_device = Eigen::Vector3d::Zero();
        // Where tools turn: from the tip as the device has it, and turned as the tool is, mm.
        Eigen::Vector3d arm = Eigen::Vector3d::Zero(), swung = Eigen::Vector3d::Zero();
        std::vector<Touch> touches;  // by deformable body
        std::vector<Hold> holds;     // the same; the last on rigid bodies
    };
    struct Tool {
        std::vector<Part> parts;
        std::size_t felt = 0, was_felt = 0;  // of the parts: in this tick, in the last one
        Eigen::Vector3d off = Eigen::Vector3d::Zero();
        Offsets next_off = no_offsets(), difference = no_offsets();  // of the answers to `off`
        Eigen::Vector3d turn = Eigen::Vector3d::Zero();              // rad, from the device's orientation on
        Offsets next_turn = no_offsets(), turn_difference = no_offsets();
        Eigen::Vector3d unpressed_turn = Eigen::Vector3d::Zero();  // of it what presses does not do
        // How it was turned at the end of the last tick, and what it keeps of that; equilibrium_turning.cpp.
        Eigen::Vector3d turn_before = Eigen::Vector3d::Zero(), kept_turn = Eigen::Vector3d::Zero();
        Eigen::Matrix3d on_device =
                            Eigen::Matrix3d::Identity(),  // as it is held; as it is turned, also at the
            R_PT = on_device, last_R_PT = on_device;      // end of the last tick
        double longest_arm = 0;                           // mm, of the parts that are felt
        Eigen::Vector3d tip = Eigen::Vector3d::Zero();    // as the device has it, mm
        Eigen::Vector3d last_device_tip = Eigen::Vector3d::Zero(), last_tip = Eigen::Vector3d::Zero();
        Eigen::Vector3d way = Eigen::Vector3d::Zero(), last_way = Eigen::Vector3d::Zero();  // of the device
        Eigen::Vector3d press = Eigen::Vector3d::Zero(), drag = Eigen::Vector3d::Zero();    // N
        double held_reach = 0;
        bool touching = false;  // tissue, at the end of the last tick
        bool cold = false;      // starts from what its god-objects say
        bool walled = false;    // walls pressed it in the last tick, and it turns by itself
        bool outside = true;    // of the tissue
        bool at_rest = false;   // no equilibrium was found
        bool cut = false;
        double reach = 0;                    // mm: triangles nearer than this to a sphere are looked at
        double near = 0, farthest_near = 0;  // mm: those nearer than this are solved; at the most
    };
};

}  // namespace palpate::haptics
