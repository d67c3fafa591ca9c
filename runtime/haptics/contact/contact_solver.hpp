// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/contact_lcp.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"

namespace palpate::haptics {

/// Gathers the contact points of all tools on all bodies and solves them as one problem, warm-started from
/// the tick before: points of one body give way together, points of one tool share its virtual coupling. The
/// equations stand in deformable_contact.cpp. One thread; realtime-safe.
class ContactSolver {
  public:
    void clear() noexcept { count_ = 0; }
    /// Forgets the tick before.
    void reset() noexcept { count_ = last_active_count_ = 0; }
    std::size_t size() const noexcept { return count_; }

    /// Adds the points of one part of a tool on one body, which is null if it is rigid. The contacts must
    /// outlive solve(). At most max_contacts in all (asserted).
    void add(std::span<Contact> contacts, const DeformableContact* body, std::int32_t tool) noexcept;

    /// Solves with a virtual coupling of compliance `coupling` (mm/N) for each tool and writes the forces
    /// into the contacts. Returns the worst violation of the contact conditions, mm.
    double solve(double coupling) noexcept;

  private:
    struct Row {
        Contact* contact = nullptr;
        const DeformableContact* body = nullptr;
        std::int32_t tool = 0;
        std::int64_t key = 0;  // what the warm start knows it by
    };
    double entry(const Row& a, const Row& b, double coupling) const noexcept;

    std::array<Row, max_contacts> rows_;
    std::size_t count_ = 0;
    ContactLcp lcp_;
    std::array<std::int64_t, max_contacts> last_active_{};
    std::size_t last_active_count_ = 0;
};

}  // namespace palpate::haptics
