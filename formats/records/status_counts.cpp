// SPDX-License-Identifier: Apache-2.0
#include "formats/records/status_counts.hpp"

namespace palpate {

void StatusCounts::add(const TickResult& result) noexcept {
    const std::uint32_t faults = result.faults & ~std::uint32_t{servo_stopping};
    faults_ |= faults;
    faulty_ += faults != no_fault;
    if (result.status == tick_ok) return;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        if (!(result.status & status_texts()[i].status)) continue;
        ++counts_[i].ticks;
        counts_[i].last = result.time;
    }
}

std::map<std::string, std::int64_t> StatusCounts::by_name() const {
    std::map<std::string, std::int64_t> names;
    for (std::size_t i = 0; i < counts_.size(); ++i)
        if (counts_[i].ticks > 0) names[status_texts()[i].name] = counts_[i].ticks;
    return names;
}

std::uint32_t StatusCounts::recent(double time) const noexcept {
    std::uint32_t flags = tick_ok;
    for (std::size_t i = 0; i < counts_.size(); ++i)
        if (counts_[i].ticks > 0 && time - counts_[i].last < reading_time) flags |= status_texts()[i].status;
    return flags;
}

std::string StatusCounts::closing_line() const {
    std::string line;
    const auto tell = [&](std::int64_t ticks, const std::string& name, const std::string& meaning) {
        line += line.empty() ? "not all ticks were as they should be: " : "; ";
        line += std::to_string(ticks) + " " + name + " (" + meaning + ")";
    };
    for (std::size_t i = 0; i < counts_.size(); ++i)
        if (status_texts()[i].told && counts_[i].ticks > 0)
            tell(counts_[i].ticks, status_texts()[i].name, status_texts()[i].meaning);
    if (faulty_ > 0) tell(faulty_, "with a fault", "the force was taken away: " + fault_names(faults_));
    return line;
}

}  // namespace palpate
