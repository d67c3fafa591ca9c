// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/run_keys.hpp"

#include <fmt/format.h>

#include "runtime/apps/start_recording.hpp"
#include "runtime/haptics/methods/contact_methods.hpp"
#include "runtime/texts/translated.hpp"
#include "runtime/visual/controls/free_path.hpp"

namespace palpate::apps {

using texts::looked_up;
using texts::translated;

std::string RunKeys::press(std::string_view key, bool exercising) {
    try {
        if (key == "o") return turn_recording();
        if (key == "a") sound_.turn();
        if (key == "j") run_.close_jaws(!run_.jaws_closed());
        if (key == "f") return exercising ? translated("not while an exercise goes on") : take_next_method();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

std::string RunKeys::turn_recording() {
    if (const auto rows = run_.recorded_rows()) {
        run_.end_recording();
        return translated("recorded {:.1f} s",
                          1e-3 * static_cast<double>(*rows) / static_cast<double>(run_.model().tool_count()));
    }
    const auto path = visual::free_path(".", run_.patient_case().name, ".h5");
    start_recording(run_, path, seconds_, session_);
    recordings_.push_back(path.filename());
    return translated("recording: {}", path.filename().string());
}

std::string RunKeys::take_next_method() {
    const auto methods = haptics::contact_methods();
    auto at = &run_.model().method() - methods.data();
    const bool is_instrument = has_instrument(run_.patient_case());
    const bool has_bone = !run_.patient_case().rigid_bodies.empty();
    const auto serves = [&](const haptics::ContactMethodEntry& method) {
        return method.can.most_tools >= run_.model().tool_count() &&
               (method.can.feels_tissue || (is_instrument && has_bone)) &&
               (method.can.turns || !is_instrument);
    };
    do at = (at + 1) % std::ssize(methods);
    while (!serves(methods[at]));
    run_.change_method(methods[at].name);
    return translated("contact '{}': {}", methods[at].name, looked_up(methods[at].sentence.data()));
}

}  // namespace palpate::apps
