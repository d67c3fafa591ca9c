// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/recording/recording.hpp"
#include "formats/records/jaw_settings.hpp"
#include "runtime/devices/device_kind.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/session/live_stream.hpp"
#include "runtime/session/run_recorder.hpp"
#include "runtime/session/watch/run_watch.hpp"

namespace palpate::session {

/// What a session is to be.
struct SessionRequest {
    std::filesystem::path asset;  ///< read, and watched while the session runs against the clock
    std::string method{haptics::usual_contact_method};  ///< a name of contact_methods()
    std::size_t tool_count = 1;
    bool virtual_clock = false;  ///< ticks as fast as possible; forces do not depend on the machine
    std::vector<std::string> trusted_keys{};  ///< of read_public_keys(), one of which must have signed the
                                              ///< asset; none: no signature is asked for
    std::optional<ToolBody> tool{};           ///< what is held, for a method with which tools turn
    std::optional<JawSettings> jaws{};        ///< of a forceps, whose jaws are the two tools
    std::vector<std::string> hyperelastic{};  ///< deformable bodies whose tissue is neo-Hookean, "all" or
                                              ///< "none"; empty: as the asset says
    std::string stream{};                     ///< "PORT" or "ADDRESS:PORT" of a live stream; empty: none
};

/// One run with a patient's model and the devices that touch it: haptic and collision loop, watch over
/// faults, live stream, recording, statistics. Prepared in three steps, each of which throws what cannot be:
/// made, hold(), and where wanted record_to(); after that start() or run_virtual(), whose ticks pump()
/// or the sink hand out. One thread, but where said otherwise.
class Session {
  public:
    using Sink = std::function<void(const TickResult&)>;

    /// Reads the asset, prepares its model, then begins to judge its compliances by its meshes: nothing ticks
    /// before that is done. `tell` gets a sentence for each fault when it begins. Throws as load_asset() and
    /// HapticModel.
    explicit Session(SessionRequest request, std::function<void(const std::string&)> tell = {});
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
    ~Session();  ///< stops

    const Case& patient_case() const noexcept { return case_; }
    const haptics::HapticModel& model() const noexcept { return *model_; }
    /// Names of the bodies whose tissue is solved for large deformation, with the scheme of now.
    std::vector<std::string> deforming_far() const {
        return model_->method().can.deforms_far ? case_.hyperelastic : std::vector<std::string>{};
    }
    /// To try forces out before the session starts; whoever does resets it.
    haptics::HapticModel& model() noexcept { return *model_; }

    /// Takes devices, one for each tool, or one for both jaws of a forceps, couples the model to what they
    /// bear and begins to listen for viewers of the stream. Once, before what follows. Throws as ServoLoop
    /// and LiveStream.
    /// `jaws`: how a forceps is turned, R_PT, where its device does not say.
    void hold(devices::OpenDevices devices, const Eigen::Quaterniond& jaws = Eigen::Quaterniond::Identity());
    /// Whether a forceps that its device does not open is to close. One thread.
    void close_jaws(bool closed) noexcept { jaws_closed_->store(closed); }
    bool jaws_closed() const noexcept { return jaws_closed_->load(); }
    /// Of a forceps; nothing where something else is held.
    const std::optional<JawSettings>& jaws() const noexcept { return request_.jaws; }
    /// Of the first device.
    std::string device_name() const { return devices_.devices.front()->name(); }
    /// Says where mouse and keyboard want a guided hand (p_P, mm) and how it is to hold a tool that turns
    /// (R_PT; zero: as it does); nothing where no hand is guided.
    void guide(const Eigen::Vector3d& place, const Eigen::Quaterniond& orientation);

    /// What a recording of this session says of it. Throws as recording_head().
    recording::RecordingHead recording_head(const std::string& version) const;
    /// Puts every tick from here on into what make_recording() made with that head, also while it runs.
    /// Throws as RunRecorder and require_answers_of_mesh().
    void record_to(const std::filesystem::path& recording);
    /// Ends the recording; the ticks go on.
    void end_recording() { recorder_.reset(); }

    /// Starts to tick against the clock; returns once the servo is set up. Throws as Servo::start() and
    /// require_answers_of_mesh(); an empty recording is removed then.
    void start();
    /// While it runs against the clock: goes on with another contact method, as ServoLoop::change_model() has
    /// it; a recording, which is of one method, ends. Earlier models stay, for others may look at their
    /// surfaces. Throws as HapticModel does; SystemFailure if the servo does not tick.
    void change_method(std::string_view name);
    /// Hands every result since the last call to watch, stream, recording and `sink`, in this thread.
    void pump(const Sink& sink);
    /// The latest result of a tool, beside pump().
    const TickResult& latest(std::size_t tool = 0) noexcept { return loop_->latest(tool).read(); }
    /// Once a frame, where there is a window: says that it still draws.
    void visual_beat() noexcept { loop_->visual_beat(); }
    /// Takes the forces to zero and ends the servo. What it left is still to be pumped.
    void stop();

    /// Ticks for `seconds` in this thread instead, as fast as possible. Throws as require_answers_of_mesh().
    void run_virtual(double seconds, const Sink& sink);

    /// Faults of the last two seconds before `time` (s), and of the whole run: see RunWatch.
    std::uint32_t recent_faults(double time) const { return watch_->recent(time); }
    nlohmann::ordered_json faults_json() const;
    /// What was unusual about the ticks taken so far.
    const StatusCounts& statuses() const { return watch_->statuses(); }
    /// Rows recorded so far; nothing without a recording.
    std::optional<std::int64_t> recorded_rows() const;
    /// Not while it runs.
    haptics::ServoStatistics statistics() const;

  private:
    void require_sound();
    void take(const TickResult& result, const Sink& sink);
    std::vector<realtime::Device*> held() const;

    SessionRequest request_;
    std::function<void(const std::string&)> tell_;
    Case case_;
    std::vector<std::unique_ptr<haptics::HapticModel>> models_;  // one for each method so far
    haptics::HapticModel* model_;                                // that ticks
    std::future<void> judged_;                                   // begun when the model is there
    devices::OpenDevices devices_;
    std::shared_ptr<std::atomic<bool>> jaws_closed_ = std::make_shared<std::atomic<bool>>(false);
    std::optional<haptics::ServoLoop> loop_;
    std::optional<RunWatch> watch_;
    std::optional<LiveStream> stream_;
    std::optional<RunRecorder> recorder_;
    std::filesystem::path recording_;
};

}  // namespace palpate::session
