// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/contact_solver.hpp"

#include <algorithm>
#include <cassert>

namespace palpate::haptics {

using Eigen::Index;
using Eigen::Vector3d;

void ContactSolver::add(std::span<Contact> contacts, const DeformableContact* body,
                        std::int32_t tool) noexcept {
    assert(contacts.size() <= rows_.size() - count_);
    std::int64_t feet = 0;
    for (Contact& contact : contacts) {
        const bool vertex = contact.triangle < 0;
        const std::int64_t place = vertex ? contact.vertices[0] : (std::int64_t{1} << 32) + feet++;
        const std::int64_t side =
            (std::int64_t{tool} << 16) + (std::int64_t{contact.part} << 8) + contact.body;
        rows_[count_++] = {&contact, body, tool, (side << 40) + place};
    }
}

double ContactSolver::entry(const Row& a, const Row& b, double coupling) const noexcept {
    const Vector3d n_a = normal_of(*a.contact), n_b = normal_of(*b.contact);
    double sum = a.tool == b.tool ? coupling * n_a.dot(n_b) : 0;
    if (a.body != nullptr && a.body == b.body)
        sum += a.body->compliance_between(*a.contact, n_a, *b.contact, n_b);
    return sum;
}

double ContactSolver::solve(double coupling) noexcept {
    std::array<std::size_t, max_contacts> warm;
    std::size_t warm_count = 0;
    const std::span last(last_active_.data(), last_active_count_);
    for (std::size_t k = 0; k < count_; ++k) {
        const auto row = static_cast<Index>(k);
        lcp_.gaps()[row] = static_cast<double>(rows_[k].contact->gap);
        for (std::size_t l = 0; l < k; ++l) {
            const auto column = static_cast<Index>(l);
            lcp_.matrix()(row, column) = lcp_.matrix()(column, row) = entry(rows_[k], rows_[l], coupling);
        }
        lcp_.matrix()(row, row) =
            entry(rows_[k], rows_[k], coupling) + static_cast<double>(rows_[k].contact->series_compliance);
        if (std::ranges::find(last, rows_[k].key) != last.end()) warm[warm_count++] = k;
    }
    const double residual = lcp_.solve(count_, std::span(warm).first(warm_count));
    last_active_count_ = 0;
    for (std::size_t k = 0; k < count_; ++k) {
        const double force = lcp_.forces()[static_cast<Index>(k)];
        rows_[k].contact->force = static_cast<float>(force);
        if (force > 0) last_active_[last_active_count_++] = rows_[k].key;
    }
    return residual;
}

}  // namespace palpate::haptics
