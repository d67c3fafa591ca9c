// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/contact/contact_lcp.hpp"
#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"
#include "runtime/haptics/contact/equilibrium/equilibrium_parts.hpp"
#include "runtime/haptics/contact/equilibrium/neighbour_contact.hpp"
#include "runtime/haptics/contact/fixed_list.hpp"
#include "runtime/haptics/contact/god_object.hpp"
#include "runtime/haptics/whole_tool/tool_spheres.hpp"

namespace palpate::haptics {

/// Finds where tools and tissue come to rest together: tools made of spheres, each pulled by its virtual
/// coupling, on deformable bodies as they are displaced and on half-spaces that rigid bodies allow, and the
/// deformable bodies on what lies beside them. The equations stand in contact_equilibrium.cpp. From
/// what was found in one tick the next one starts, or from where going on as before leads. One thread;
/// realtime-safe: everything is allocated on construction.
class ContactEquilibrium : private EquilibriumParts {
  public:
    using EquilibriumParts::Sphere;

    /// `bodies` must outlive this. Tools of these spheres. `are_one_surface`: what presses one sphere of a
    /// tool sinks in the others as it does on one surface; otherwise each sinks in as if it were alone.
    ContactEquilibrium(const ContactBodies& bodies, std::span<const ToolSphere> spheres, bool are_one_surface,
                       const Friction& friction, std::size_t tool_count);

    ~ContactEquilibrium();

    /// Forgets all contact, of all tools or of one.
    void reset() noexcept;
    void forget(std::size_t tool) noexcept;

    /// Leaves a tool that turns as it was turned at the end of the last tick, its tip at `tip` (p_P, mm),
    /// with all contact forgotten; false where it was not felt then.
    bool stay(std::size_t tool, const Eigen::Vector3d& tip) noexcept;

    /// From now on deformable body `soft` leans on a shape of large deformation, which must outlive that.
    void take_shape(std::size_t soft, const LargeShape* shape) noexcept { patches_[soft].take_shape(shape); }
    /// Calls `take` with each vertex of deformable body `soft` and what presses it, N; some may come twice.
    template <typename Take>
    void each_force(std::size_t soft, const Take& take) const noexcept {
        patches_[soft].each_force(take);
    }

    /// Starts a tick behind virtual couplings of `stiffness` (N/mm), without tools or walls. `torsion`: by
    /// how much a tool turns against its device under a torque, rad / (N mm); 0: as the device says.
    void begin_tick(double stiffness, double torsion) noexcept;
    /// Places a tool whose tip is at `tip` on its device, p_P, mm, turned by R_PT there: its spheres that are
    /// felt, the first ones of all.
    void pull(std::size_t tool, const Eigen::Vector3d& tip, const Eigen::Matrix3d& orientation,
              std::span<const Sphere> spheres) noexcept;
    /// Adds a half-space of a rigid body that holds part contact.part of a tool: contact.gap says how far the
    /// device is beyond it along -normal. The contact must outlive solve(). Only where there is room
    /// (asserted).
    void add_wall(std::size_t tool, Contact& contact) noexcept;
    bool walls_are_full() const noexcept;
    /// Drops all walls of a tool, whose contacts may go then; the last solution stays as it is.
    void drop_walls(std::size_t tool) noexcept;
    /// Drops the walls that do not press a tool in the last solution, which stays as it is; those that do are
    /// moved to the front of `contacts`, where all of them lie. Returns their number.
    std::size_t drop_idle_walls(std::size_t tool, std::span<Contact> contacts) noexcept;
    /// Whether a tool touches a deformable body, or is about to.
    bool touches_tissue(std::size_t tool) const noexcept {
        return tools_[tool].felt > 0 && tools_[tool].touching;
    }

    /// Solves from where the last tick or call ended; the first call of a tick from where going on as in the
    /// last one leads.
    void solve() noexcept;

    /// Whether a tool's equilibrium was found; if not, what the other members say of it is what the surface
    /// at rest answers.
    bool solved(std::size_t tool) const noexcept { return !tools_[tool].at_rest; }
    /// How far it is off its device, mm.
    const Eigen::Vector3d& off(std::size_t tool) const noexcept { return tools_[tool].off; }
    /// What presses the tool, and what friction on tissue adds, and on walls where tools turn, N.
    const Eigen::Vector3d& press(std::size_t tool) const noexcept { return tools_[tool].press; }
    const Eigen::Vector3d& drag(std::size_t tool) const noexcept { return tools_[tool].drag; }
    /// How a tool is turned against its device, a rotation vector, rad.
    const Eigen::Vector3d& turn(std::size_t tool) const noexcept { return tools_[tool].turn; }
    /// How far a sphere of it is off where its device has it because it is turned, mm.
    Eigen::Vector3d turned_off(std::size_t tool, std::size_t part) const noexcept {
        return off_of(tools_[tool], tools_[tool].parts[part]) - tools_[tool].off;
    }
    /// How far the tool was off its device before this tick, plus how far the device went since, mm: contact
    /// that friction holds goes no farther off.
    double held_reach(std::size_t tool) const noexcept { return tools_[tool].held_reach; }
    /// Whether it touches more than could be solved, and part of it was left out.
    bool was_cut(std::size_t tool) const noexcept {
        return tools_[tool].cut || (tools_[tool].touching && neighbours_.was_cut());
    }
    /// Worst violation of the contact conditions, mm.
    double residual() const noexcept { return residual_; }
    /// By how much the last answer differs from the state of tools and tissue that it answers, mm; and what
    /// is too much: 5 mN behind the usual coupling.
    double change() const noexcept { return change_; }
    static constexpr double unsettled = 1e-2;
    /// Appends the contacts with deformable bodies that press the tool.
    void write_contacts(std::size_t tool, TickResult& result) const noexcept;
    /// Appends those of deformable bodies with what lies beside them.
    void write_neighbours(TickResult& result) const noexcept { neighbours_.write_contacts(result); }
    /// Ends the tick: what this one found is the start of the next.
    void end_tick() noexcept;

  private:
    static constexpr std::size_t most_walls = 48;  // leaves room for tissue
    static constexpr double settled = 1e-4;        // mm: changes smaller than this end the search
    // How far a combination of answers may go ahead of the newest, in changes that this made; and what both
    // come to.
    static constexpr double farthest_ahead = 4, walked_ahead = farthest_ahead + 1;
    // mm beyond a sphere within which triangles count: of a tool at rest, and where contact starts.
    static constexpr double first_reach = 0.1, cold_reach = 0.5;
    // Where the state is foreseen, only what is nearer than this part of Tool::near is solved, for so many
    // rounds.
    static constexpr double foreseen = 0.1;
    static constexpr int foreseen_rounds = 2;
    // For so many rounds it is looked for what slides on walls.
    static constexpr int grip_rounds = 4;

    static void find_part_giving_way(Row& row, const DeformedPatch& patch,
                                     const collision::TriangleCorners& met) noexcept;
    // Of a sphere and a triangle; patch -1: of a rigid body.
    static std::int64_t key_of(std::int64_t tool, std::int64_t part, std::int64_t patch,
                               std::int64_t triangle) noexcept {
        return (((tool << 16) + (part << 8) + patch + 1) << 32) + triangle;
    }
    static std::int64_t key_of(const Row& row) noexcept;
    std::size_t wall_count() const noexcept;
    double gap_of_wall(const Row& row) const noexcept;
    std::array<float, 3> friction_of(const Row& row) const noexcept;
    void gather_at_rest(std::size_t tool, std::size_t part) noexcept;
    // N: up to which a sphere sinks in as it does under that, in proportion.
    static double slight_press(double radius, const LoadSpread& spread) noexcept {
        return 1e-3 * spread.contact_modulus() * radius * radius;
    }
    static void linearise(double radius, Touch& touch, const DeformedPatch& patch) noexcept;
    // How the sphere is sunk in if nothing presses it, mm: by what earlier presses left behind.
    static Eigen::Vector3d local_dent(double radius, const Touch& touch, const DeformedPatch& patch) noexcept;
    // What presses under it as far as local indentation is concerned, N.
    static Eigen::Vector3d pushed_by(const Touch& touch) noexcept {
        return touch.creep != nullptr ? Eigen::Vector3d(touch.creep->now * touch.push + touch.lasting_push)
                                      : touch.push;
    }
    void share_sinking(std::size_t iterate) noexcept;
    void remember_pushes() noexcept;
    bool turns() const noexcept { return torsion_ > 0; }
    Eigen::Vector3d off_of(const Tool& tool, const Part& part) const noexcept {
        return turns() ? Eigen::Vector3d(tool.off + (part.swung - part.arm)) : tool.off;
    }
    // Of that what is there without what presses, and the rest, as forces answer: they turn a tool in
    // proportion.
    Eigen::Vector3d dragged_off_of(const Tool& tool, const Part& part) const noexcept {
        const Eigen::Vector3d off = tool.drag / coupling_;
        return turns() ? Eigen::Vector3d(off + tool.unpressed_turn.cross(part.swung)) : off;
    }
    Eigen::Vector3d pressed_off_of(const Tool& tool, const Part& part) const noexcept {
        const Eigen::Vector3d off = tool.off - tool.drag / coupling_;
        return turns() ? Eigen::Vector3d(off + (tool.turn - tool.unpressed_turn).cross(part.swung)) : off;
    }
    // In equilibrium_turning.cpp, of tools that turn by themselves.
    static void swing(Tool& tool) noexcept;
    static void pull_arms(Tool& tool) noexcept;
    void find_levers() noexcept;
    void add_levers(std::size_t column) noexcept;
    double answer_turns(std::size_t iterate) noexcept;
    void resist_turning() noexcept;
    Eigen::Vector3d turn_by_drags(const Tool& tool) const noexcept;
    void relax_turn(Tool& tool, const Weights& weights, double step) const noexcept;
    Eigen::Vector3d centre_of(const Tool& tool, const Part& part, const Touch& touch) const noexcept {
        return part.sphere.device + off_of(tool, part) + touch.sunk;
    }
    void look_around(std::size_t tool, std::size_t part, std::size_t soft) noexcept;
    bool gather(std::size_t tool, std::size_t part, std::size_t soft) noexcept;
    bool follow(Touch& touch, const Eigen::Vector3d& centre, const DeformedPatch& patch) const noexcept;
    bool stays_outside(const Part& part, const Touch& touch, const DeformedPatch& patch,
                       const Eigen::Vector3d& centre, double nearest) const noexcept;
    bool found(std::size_t tool) const noexcept;
    bool start_anew() noexcept;
    void forget_tissue() noexcept;
    void leave_tissue(std::size_t tool) noexcept;
    void forget_groups() noexcept;
    void iterate(int most) noexcept;
    bool is_active(std::int64_t key) const noexcept;
    bool watched_are_clear() const noexcept;
    void cut_rows() noexcept;
    void group_rows() noexcept;
    void group_rows(std::size_t first, std::size_t end, FixedList<Group, max_contacts>& groups) noexcept;
    void find_slots_of_rows() noexcept;
    void solve_rows() noexcept;
    // By how much a force of a row sinks in another sphere of its tool, mm/N.
    double shared_by(const Row& pressing, std::int32_t part) const noexcept {
        const Eigen::MatrixXd& beside = beside_[static_cast<std::size_t>(pressing.patch)];
        if (beside.size() == 0) return 0;
        const Touch& touch = touch_of(pressing);
        return (touch.creep != nullptr ? touch.creep->now : 1) * beside(part, pressing.part);
    }
    void fill_any_column(std::size_t row) noexcept;
    void fill_column(std::size_t row) noexcept;
    void fill_neighbours_column(std::size_t row) noexcept;
    // Of a row or a group of rows.
    const Part& part_of(const auto& of) const noexcept {
        return tools_[static_cast<std::size_t>(of.tool)].parts[static_cast<std::size_t>(of.part)];
    }
    const Touch& touch_of(const auto& of) const noexcept {
        return part_of(of).touches[static_cast<std::size_t>(of.patch)];
    }
    Touch& touch_of(const auto& of) noexcept { return const_cast<Touch&>(std::as_const(*this).touch_of(of)); }
    const Hold& hold_of(const auto& of) const noexcept {
        return part_of(of).holds[of.patch < 0 ? patches_.size() : static_cast<std::size_t>(of.patch)];
    }
    Hold& hold_of(const auto& of) noexcept { return const_cast<Hold&>(std::as_const(*this).hold_of(of)); }
    const DeformedPatch& patch_of(const auto& of) const noexcept {
        return patches_[static_cast<std::size_t>(of.patch)];
    }
    DeformedPatch& patch_of(const auto& of) noexcept { return patches_[static_cast<std::size_t>(of.patch)]; }
    std::span<const Row> rows_of(const Group& group) const noexcept {
        return {rows_.data() + group.first, group.end - group.first};
    }
    double sink(std::size_t iterate) noexcept;
    double answer(std::size_t iterate) noexcept;
    void rub(std::size_t iterate) noexcept;
    void keep_hold_of_walls() noexcept;
    void keep_hold_of_tissue() noexcept;
    void keep_hold(const Rubbing& rubbing) noexcept;
    void find_bearings(const Group& group, Bearings& bearings) const noexcept;
    Eigen::Vector3d free_slip_of(const Rubbing& rubbing) const noexcept;
    void find_rubbing() noexcept;
    bool measure_press(const Group& group) noexcept;
    double most_drag(const Group& group, double coefficient) const noexcept;
    void hold_alone(Rubbing& rubbing) noexcept;
    void begin_hold(Rubbing& rubbing) const noexcept;
    void add_tangents(Rubbing& rubbing) noexcept;
    void add_known_drag(const Rubbing& rubbing) noexcept;
    bool regrip(Rubbing& rubbing) noexcept;
    bool go_on_sliding(Rubbing& rubbing) noexcept;
    bool change_grip() noexcept;
    bool cut_drags() noexcept;
    void solve_held(const ContactLcp::Vector& gaps, bool walls) noexcept;
    Eigen::Vector3d slip_after(const Rubbing& rubbing) const noexcept;
    template <typename Take>
    void each_opening(const Rubbing& rubbing, const Eigen::Vector3d& drag, const Take& take) noexcept;
    double shearing(const Group& group) const noexcept;
    // What is left of it from before: a harder press adds nothing to the drag, or it would give energy.
    Eigen::Vector3d slip_before(const Group& group) const noexcept {
        const Hold& hold = hold_of(group);
        const double now = shearing(group);
        return now < hold.sheared ? Eigen::Vector3d(now / hold.sheared * hold.slip) : hold.slip;
    }
    // From the tip to the point of a sphere that rubs: of a tool that does not turn, the sphere's centre.
    Eigen::Vector3d rubbing_arm(const Part& part, const Hold& hold) const noexcept {
        return turns() ? Eigen::Vector3d(part.swung - part.radius * hold.axis) : part.swung;
    }
    // Where there is friction, calls `take` with each hold of a tool's spheres.
    void each_hold(auto& tool, const auto& take) const noexcept {
        if (!friction_.any()) return;
        for (auto& part : tool.parts)
            for (auto& hold : part.holds) take(hold);
    }
    Eigen::Vector3d way_past(const Group& group) const noexcept;
    void hold_together() noexcept;
    void fill_tangent(std::size_t tangent) noexcept;
    void take_forces() noexcept;
    Eigen::Vector3d slip_of(const Group& group, const Bearings& bearings) const noexcept;
    // The answer that the iteration of a tick gives; and those that are carried over from a tick before.
    std::size_t answer_of(std::size_t iteration) const noexcept {
        return iteration < first_answers ? bank_ * first_answers + iteration
                                         : 2 * first_answers + iteration % first_answers;
    }
    std::size_t carried_answer(std::size_t k) const noexcept { return (1 - bank_) * first_answers + k; }
    void carry_over() noexcept;
    void go_on() noexcept;
    void look_widely() noexcept;
    bool is_steady() const noexcept;
    double steadiness() const noexcept;
    void compare(std::size_t iteration) noexcept;
    Weights mix(std::size_t iteration, std::size_t known, std::size_t carried) const noexcept;
    static Weights alone(std::size_t answer) noexcept {
        Weights weights{};
        weights[answer] = 1;
        return weights;
    }
    static Eigen::Vector3d combined(const Weights& weights, const Offsets& answers) noexcept {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < weights.size(); ++k)
            if (weights[k] != 0) sum += weights[k] * answers[k];
        return sum;
    }
    static Weights between(const Weights& from, const Weights& to, double share) noexcept {
        Weights weights{};
        for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = from[k] + share * (to[k] - from[k]);
        return weights;
    }
    Weights next_state(std::size_t iteration, std::size_t known, double change) noexcept;
    double departure(const Weights& weights, std::size_t from) const noexcept;
    bool climbs(const Weights& weights, std::size_t newest) const noexcept;
    void relax_to(const Weights& weights, double longest) noexcept;

    const ContactBodies& bodies_;
    Friction friction_;
    double coupling_ = 0, torsion_ = 0;
    bool resists_turning_ = false;
    bool may_change_grip_ = true;  // on walls
    std::size_t solves_ = 0;       // of the problem of this iteration's rows
    double turn_change_ = 0;       // of change_ what turning is
    std::vector<DeformedPatch> patches_;
    NeighbourContact neighbours_;
    std::vector<Tool> tools_;
    bool are_one_surface_;
    // By deformable body: how far a force on one sphere of a tool sinks another in, mm/N.
    std::vector<Eigen::MatrixXd> beside_;
    FixedList<Row, most_rows> rows_;                    // of this iteration, walls first
    std::array<Eigen::Vector3d, max_contacts> levers_;  // r x n about the tip of each, mm, where tools turn
    FixedList<Row, most_rows> watched_;                 // near, but hardly pressing: looked after, not solved
    FixedList<Group, max_contacts> wall_groups_, groups_;  // of those on walls, on tissue
    FixedList<Rubbing, max_contacts> rubbing_;             // of the groups that press
    FixedList<Tangent, ContactLcp::most_tangents> tangents_;
    std::vector<std::vector<std::uint32_t>> visited_;  // by patch and triangle: the search that saw it last
    std::uint32_t search_ = 0;
    std::int64_t round_ = 0;  // of all searches
    FixedList<std::int32_t, most_rows> queue_;
    FixedList<Near, most_near> passed_over_;           // of what is near a sphere: clear of it
    std::array<std::int64_t, max_contacts> active_{};  // keys of rows that pressed in the last solution
    std::size_t active_count_ = 0;
    ContactLcp lcp_;
    DeformedPatch::Field field_;  // of a row's force
    FixedList<std::int32_t, static_cast<std::size_t>(DeformedPatch::most_vertices)> slots_of_rows_;
    // Inner products of the answers' differences from their states, mm²; where this tick's answers are, how
    // many of the first there are in a row, and how many are left of a tick before.
    Eigen::Matrix<double, DeformedPatch::iterates, DeformedPatch::iterates> products_;
    std::size_t bank_ = 0, in_row_ = 0, carried_ = 0;
    std::size_t state_ = first_state, states_known_ = 0;  // of the one in which this tick began; in a row
    bool begins_ = false;                                 // this tick, which nothing was solved in
    double residual_ = 0, change_ = 0;
    double last_motion_ = 0;    // mm, of tissue, in the tick before
    int spare_iterations_ = 0;  // left in this tick
};

}  // namespace palpate::haptics
