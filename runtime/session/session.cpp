// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "formats/asset/asset.hpp"
#include "formats/elasticity/plausible_compliance.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/jaws/jaws.hpp"

namespace palpate::session {
namespace {

std::vector<std::string> hyperelastic_bodies(const SessionRequest& request,
                                             const std::vector<DeformableBody>& bodies) {
    const auto asks = [&](const char* word) {
        return std::ranges::find(request.hyperelastic, word) != request.hyperelastic.end();
    };
    if (asks("none")) return {};
    if (!request.hyperelastic.empty() && !asks("all")) return request.hyperelastic;
    if (asks("all") && bodies.empty())
        throw InvalidInput(
            {request.asset.string(), "has no deformable body", "", "leave out --large-deformation"});
    std::vector<std::string> names;
    for (const DeformableBody& body : bodies)
        if (asks("all") || body.large_deformation) names.push_back(body.name);
    return names;
}

Case case_of(const SessionRequest& request) {
    Case patient_case = asset::load_asset(request.asset, request.trusted_keys);
    patient_case.tool = request.tool;
    if (request.jaws) patient_case.haptics = held_between(*request.jaws, patient_case.haptics);
    patient_case.hyperelastic = hyperelastic_bodies(request, patient_case.deformable_bodies);
    return patient_case;
}

// Whether its compliances answer as its meshes do, beside what still comes before the first tick.
std::future<void> judged(const Case& patient_case, const std::filesystem::path& asset) {
    return std::async(std::launch::async, [&patient_case, asset] {
        for (const DeformableBody& body : patient_case.deformable_bodies)
            elasticity::require_answers_of_mesh(body, asset.string() + ": compliance of " + body.name,
                                                std::random_device{}());
    });
}

}  // namespace

Session::Session(SessionRequest request, std::function<void(const std::string&)> tell)
    : request_(std::move(request)),
      tell_(std::move(tell)),
      case_(case_of(request_)),
      model_(models_
                 .emplace_back(
                     std::make_unique<haptics::HapticModel>(case_, request_.method, request_.tool_count))
                 .get()),
      judged_(judged(case_, request_.asset)) {}

Session::~Session() {
    stop();
}

void Session::hold(devices::OpenDevices devices, const Eigen::Quaterniond& jaws) {
    devices_.driver = std::move(devices.driver);
    devices_.devices = std::move(devices.devices);
    if (request_.jaws && devices_.devices.size() != 1)
        throw InvalidInput({"a forceps", std::to_string(devices_.devices.size()) + " devices", "one", ""});
    if (request_.jaws)
        std::ranges::move(devices::jaws_of(std::exchange(devices_.devices, {}).at(0), *request_.jaws,
                                           {.orientation = jaws, .closed = jaws_closed_}),
                          std::back_inserter(devices_.devices));
    devices_.servo = devices.servo;
    devices_.guide = std::move(devices.guide);
    loop_.emplace(*model_, held(), devices_.servo);
    // Without a clock there is no time in which the asset could go.
    watch_.emplace(request_.virtual_clock ? std::filesystem::path() : request_.asset, *loop_,
                   [this](const std::string& sentence) {
                       if (tell_) tell_(sentence);
                   });
    if (!request_.stream.empty()) stream_.emplace(request_.stream, case_, model_->tool_count());
}

void Session::require_sound() {
    if (judged_.valid()) judged_.get();
}

void Session::guide(const Eigen::Vector3d& place, const Eigen::Quaterniond& orientation) {
    if (devices_.guide) devices_.guide(place, orientation);
}

recording::RecordingHead Session::recording_head(const std::string& version) const {
    recording::RecordingHead head = palpate::session::recording_head(
        request_.asset, case_, *model_, held(), request_.virtual_clock ? "virtual" : "real", version);
    head.jaws = request_.jaws;
    return head;
}

void Session::record_to(const std::filesystem::path& recording) {
    require_sound();
    recorder_.emplace(recording);
    recording_ = recording;
}

void Session::start() {
    try {
        require_sound();
        loop_->start();
    } catch (...) {
        if (recorder_) std::filesystem::remove(recording_);  // it holds nothing
        throw;
    }
}

void Session::change_method(std::string_view name) {
    if (name == model_->method().name) return;
    const auto made =
        std::ranges::find(models_, name, [](const auto& model) { return model->method().name; });
    auto& model = made != models_.end() ? **made
                                        : *models_.emplace_back(std::make_unique<haptics::HapticModel>(
                                              case_, name, model_->tool_count()));
    model.reset();
    end_recording();
    if (!loop_->change_model(model))
        throw SystemFailure({"the servo", "has not changed its contact method within a quarter of a second",
                             "1000 ticks a second", "check the device, then 'palpate doctor'"});
    model_ = &model;
}

void Session::pump(const Sink& sink) {
    for (TickResult result; loop_->ring().pop(result);) take(result, sink);
}

void Session::take(const TickResult& result, const Sink& sink) {
    watch_->add(result);
    if (stream_) stream_->show(result);
    if (recorder_) {
        recorder_->add(result);
        if (!request_.virtual_clock) recorder_->set_lost(loop_->ring().dropped());
    }
    sink(result);
}

void Session::stop() {
    if (loop_) loop_->stop();
}

void Session::run_virtual(double seconds, const Sink& sink) {
    require_sound();
    loop_->run_virtual(static_cast<std::int64_t>(std::llround(1000 * seconds)),
                       [&](const TickResult& result) { take(result, sink); });
}

nlohmann::ordered_json Session::faults_json() const {
    return watch_->faults_json();
}

std::optional<std::int64_t> Session::recorded_rows() const {
    return recorder_ ? std::optional(recorder_->rows()) : std::nullopt;
}

haptics::ServoStatistics Session::statistics() const {
    haptics::ServoStatistics statistics = loop_->statistics();
    if (request_.virtual_clock)
        statistics.lost_records = 0;  // the sink got them all, and nobody reads the ring
    return statistics;
}

std::vector<realtime::Device*> Session::held() const {
    std::vector<realtime::Device*> held;
    for (const auto& device : devices_.devices) held.push_back(device.get());
    return held;
}

}  // namespace palpate::session
