// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/replay.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/asset/asset.hpp"
#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/haptics/contact/large_shape.hpp"
#include "runtime/session/run_recorder.hpp"

namespace palpate::session {
namespace {

using namespace haptics;
using namespace recording;

using Vector = std::array<double, 3>;
constexpr int free_ticks_to_start = 3;

using Rows = std::span<const Tick>;  // of one tick, one for each tool

bool is_zero(const Vector& v) {
    return std::ranges::all_of(v, [](double x) { return x == 0; });
}

bool is_free(const Tick& row) {
    return row.status == tick_ok && row.faults == no_fault && row.contact_count == 0 && row.depth == 0 &&
           is_zero(row.force) && is_zero(row.torque);
}

bool same_bits(const Vector& a, const Vector& b) {
    using Bits = std::array<std::uint64_t, 3>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

// A difference that is no number is the largest.
void raise(double& largest, const Vector& a, const Vector& b) {
    const double size = (vector_of(a) - vector_of(b)).norm();
    if (!(size <= largest)) largest = size;
}

// The ticks that are there for every tool.
std::vector<Rows> whole_ticks(const Recording& recording) {
    const std::size_t tools = recording.head.devices.size();
    const std::span all(recording.ticks);
    std::vector<Rows> ticks;
    for (std::size_t at = 0; at + tools <= all.size();) {
        // In ascending order, so many rows of one tick are one for each tool.
        if (all[at].tick == all[at + tools - 1].tick) {
            ticks.push_back(all.subspan(at, tools));
            at += tools;
        } else {
            ++at;
        }
    }
    return ticks;
}

// One run through a recording.
class Player {
  public:
    Player(const Recording& recording, HapticModel& model, const std::function<void(const TickResult&)>& sink)
        : ticks_(whole_ticks(recording)),
          model_(model),
          sink_(sink),
          states_(model.tool_count()),
          results_(model.tool_count()) {
        model.keep_forces();
    }

    ReplayOutcome play() {
        for (std::size_t k = 0; k < ticks_.size(); ++k) {
            const Rows rows = ticks_[k];
            const bool follows = k > 0 && rows[0].tick == ticks_[k - 1][0].tick + 1;
            if (!follows) {
                running_ = false;
                free_ticks_ = 0;
            }
            free_ticks_ = std::ranges::all_of(rows, is_free) ? free_ticks_ + 1 : 0;
            if (running_ ? tick(rows) : start(rows)) {
                compare(rows);
            } else {
                running_ = false;
                ++outcome_.skipped_ticks;
            }
        }
        if (!ticks_.empty())
            outcome_.missing_ticks = ticks_.back()[0].tick + 1 - static_cast<std::int64_t>(ticks_.size());
        return outcome_;
    }

  private:
    bool start(Rows rows) {
        const bool first = rows[0].tick == 0;
        if (!first && free_ticks_ < free_ticks_to_start + model_.memory_ticks()) return false;
        if (!first && model_.detects() != Detects::nothing && rows[0].detected_tick < 0) return false;
        model_.reset();
        model_.count_from(rows[0].tick);
        first_tick_ = rows[0].tick;
        if (!tick(rows)) return false;
        // A tool within a hair of a surface counts as inside for a fresh model.
        const bool clear = std::ranges::none_of(
            results_, [](const TickResult& result) { return result.status & starts_inside; });
        running_ = first || clear;
        if (running_ && !outcome_.started) outcome_.started = rows[0].tick;
        return running_;
    }

    // False if it depends on a position that is missing.
    bool tick(Rows rows) {
        if (rows[0].detected_tick >= 0) {
            const std::int64_t wanted = rows[0].detected_tick;
            const auto detected =
                std::ranges::lower_bound(ticks_, wanted, {}, [](Rows r) { return r[0].tick; });
            if (detected == ticks_.end() || (*detected)[0].tick != wanted) return false;
            if (model_.detects() == Detects::forces && rows[0].tick - wanted >= remembered_ticks)
                return false;
            // Of forces from before the start, nothing is known but that there were none.
            if (model_.detects() == Detects::forces && wanted < first_tick_ &&
                !std::ranges::all_of(*detected, is_free))
                return false;
            model_.detect_at((*detected)[0].device_position, wanted);
        }
        std::ranges::transform(rows, states_.begin(), state_of);
        model_.tick(states_, results_);
        return true;
    }

    void compare(Rows rows) {
        bool different = false;
        for (std::size_t t = 0; t < rows.size(); ++t) {
            TickResult& result = results_[t];
            const Tick& row = rows[t];
            result.tick = row.tick;
            result.tick_ns = row.tick_ns;
            result.wake_latency_ns = row.wake_latency_ns;
            result.overruns = row.overruns;
            sink_(result);
            if (same_bits(result.force, row.force) && same_bits(result.torque, row.torque)) continue;
            different = true;
            if (!outcome_.first_difference)
                outcome_.first_difference = {row.tick,     row.tool,   row.force,
                                             result.force, row.torque, result.torque};
            raise(outcome_.largest_difference, result.force, row.force);
            raise(outcome_.largest_torque_difference, result.torque, row.torque);
        }
        ++outcome_.ticks;
        if (different) ++outcome_.different_ticks;
    }

    std::vector<Rows> ticks_;
    HapticModel& model_;
    const std::function<void(const TickResult&)>& sink_;
    std::vector<realtime::DeviceState> states_;
    std::vector<TickResult> results_;
    bool running_ = false;
    std::int64_t first_tick_ = 0;
    std::int64_t free_ticks_ = 0;
    ReplayOutcome outcome_;
};

}  // namespace

void check_asset(const Recording& recording, const std::filesystem::path& file,
                 const std::filesystem::path& asset) {
    const RecordingHead& head = recording.head;
    const std::string digest = asset::asset_digest(asset);
    if (digest != head.asset_digest)
        throw InvalidInput(
            {file.string(),
             "is of an asset of case '" + head.case_name + "' with SHA-256 " + head.asset_digest,
             digest + ", that of " + asset.string(), "replay it on the asset that was touched"});
}

Case recorded_case(const Recording& recording, const std::filesystem::path& file,
                   const std::filesystem::path& asset, std::span<const std::string> trusted_keys) {
    check_asset(recording, file, asset);
    Case patient_case = asset::read_asset(asset, trusted_keys);
    patient_case.haptics = recording.head.haptics;
    patient_case.tool = recording.head.tool;
    patient_case.hyperelastic = recording.head.hyperelastic;
    return patient_case;
}

std::unique_ptr<HapticModel> model_of(const Recording& recording, const std::filesystem::path& file,
                                      const Case& patient_case) {
    const RecordingHead& head = recording.head;
    const ContactMethodEntry& method = find_contact_method(head.scheme, file.string() + ": scheme");
    auto model = std::make_unique<HapticModel>(patient_case, method.name, head.devices.size());
    std::vector<DeviceLimits> limits;
    std::ranges::transform(head.devices, std::back_inserter(limits), &RecordedDevice::limits);
    model->couple_to(limits);
    if (model->coupling() != head.coupling_stiffness)
        throw InvalidInput({file.string(),
                            "its coupling is " + std::to_string(head.coupling_stiffness) + " N/mm",
                            std::to_string(model->coupling()) + " N/mm for its devices",
                            "replay it with palpate " + head.palpate_version});
    return model;
}

void require_all_ticks(const Recording& recording, const std::filesystem::path& file) {
    if (recording.head.every > 1)
        throw InvalidInput(
            {file.string(), "keeps one tick of " + std::to_string(recording.head.every) + " alone",
             "a recording of --record, with every tick", "look at it with 'palpate train CASE --play FILE'"});
}

ReplayOutcome replay(const Recording& recording, HapticModel& model,
                     const std::function<void(const TickResult&)>& sink) {
    return Player(recording, model, sink).play();
}

}  // namespace palpate::session
