// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/touch_outputs.hpp"

#include "formats/model/errors.hpp"
#include "runtime/session/force_curve.hpp"

namespace palpate::apps {

using namespace session;

TouchOutputs::TouchOutputs(std::filesystem::path log, const std::filesystem::path& curve,
                           const cli::Session& session)
    : log_path_(std::move(log)) {
    if (!log_path_.empty()) {
        log_.open(log_file_.emplace(log_path_, session.force).path());
        write_log_head(log_);
    }
    if (!curve.empty()) curve_file_.emplace(curve, session.force);
}

std::vector<RunRecord> TouchOutputs::records_of(const haptics::HapticModel& model) {
    return {model.tool_count(), RunRecord(model, log_file_ ? &log_ : nullptr)};
}

void TouchOutputs::commit(const RunRecord& first, const std::string& title) {
    if (log_file_) {
        log_.close();
        if (!log_) throw SystemFailure({log_path_.string(), "could not be written", "", "check free space"});
    }
    if (curve_file_) {
        curve_file_->write_text(force_curve_svg(first.curve(), title));
        curve_file_->commit();
    }
    if (log_file_) log_file_->commit();
}

}  // namespace palpate::apps
