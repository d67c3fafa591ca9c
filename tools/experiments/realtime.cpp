// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/realtime.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "formats/asset/asset.hpp"
#include "formats/recording/recording_writer.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/session/session.hpp"
#include "runtime/session/statistics_json.hpp"
#include "runtime/session/touch_target.hpp"
#include "runtime/session/watch/fault_log.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace realtime;
using namespace session;

using Json = nlohmann::ordered_json;

constexpr int hog_count = 4;
constexpr std::string_view realtime_explanation =
    "The servo loop against the clock at 1 kHz, a simulated Touch in a hand that gives way (0.3 N/mm) which "
    "pushes, slides and leaves, while four other processes do nothing but count. A tick is reading, contact, "
    "force and writing, by the wall's clock, so it contains what the system takes in the middle of it; every "
    "one is recorded to a file beside it. "
    "`missed` "
    "are periods skipped, `lost` ticks that the record does not hold.\n\n"
    "| case | priority | min | tick p50 / p99 / p99.9 / max, µs | woken late p50 / p99 / p99.9 / max, µs | "
    "missed | pauses of 10 ms or more | lost |\n"
    "|---|---|--:|--:|--:|--:|--:|--:|\n";

// Processes that keep every core busy.
class Hogs {
  public:
    Hogs() {
        for (pid_t& hog : hogs_) {
            hog = fork();
            if (hog != 0) continue;
            prctl(PR_SET_PDEATHSIG, SIGKILL);
            for (std::atomic<std::uint64_t> count = 0;;) ++count;
        }
    }
    Hogs(const Hogs&) = delete;
    Hogs& operator=(const Hogs&) = delete;
    ~Hogs() {
        for (const pid_t hog : hogs_)
            if (hog > 0 && kill(hog, SIGKILL) == 0) waitpid(hog, nullptr, 0);
    }

  private:
    std::array<pid_t, hog_count> hogs_{};
};

struct RealtimeRun {
    haptics::ServoStatistics statistics;
    std::int64_t recorded = 0;
    FaultLog faults;
    bool fifo = false;
};

// `recording`: the file of every tick, as palpate touch --record writes it; removed at the end.
RealtimeRun run_against_the_clock(const std::filesystem::path& asset, PeriodicServo::Priority priority,
                                  double seconds, std::uint64_t seed,
                                  const std::filesystem::path& recording) {
    PeriodicServo servo(priority);  // outlives the session
    Session session({.asset = asset});
    const TouchTarget target = choose_touch_target(session.patient_case(), session.model(), "", {});
    HandPath path = random_path(
        target.place,
        {.tool_radius = session.model().settings().tool_radius, .depth = 6, .speed = 60, .seconds = seconds},
        seed);
    session.hold({.devices = {std::make_shared<DynamicDevice>(find_device_model("touch"), HandImpedance{},
                                                              std::move(path))},
                  .servo = &servo});
    std::filesystem::remove(recording);
    recording::make_recording(recording, session.recording_head(cli::version()),
                              recording_rows(seconds + 1, 1));
    session.record_to(recording);
    RealtimeRun run;
    double time = 0;
    const Session::Sink take = [&](const TickResult& result) {
        time = result.time;
        run.faults.add(result);
    };
    session.start();
    while (time < seconds) {
        session.pump(take);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    session.stop();
    session.pump(take);
    run.recorded = *session.recorded_rows();
    std::filesystem::remove(recording);
    run.statistics = session.statistics();
    const auto& setup = run.statistics.setup;
    run.fifo = priority == PeriodicServo::Priority::fifo && !setup.empty() && setup.back().ok;
    return run;
}

std::string percentiles(const Histogram& histogram) {
    const auto us = [&](double fraction) {
        return static_cast<double>(histogram.percentile(fraction)) / 1000;
    };
    return fmt::format("{:.1f} / {:.0f} / {:.0f} / {:.0f}", us(0.5), us(0.99), us(0.999),
                       static_cast<double>(histogram.max()) / 1000);
}

}  // namespace

Findings realtime(const Options& options, cli::Session& session) {
    if (options.cases.empty()) throw UsageError({"--case", "none is given", "one asset or more", ""});
    const double seconds = options.seconds > 0 ? options.seconds : 600;
    Findings findings;
    findings.table = realtime_explanation;
    Json runs = Json::array();
    const Hogs hogs;
    for (const auto& file : options.cases) {
        const Case patient_case = asset::load_asset(file);
        for (const auto priority : {PeriodicServo::Priority::fifo, PeriodicServo::Priority::none}) {
            session.progress.step(patient_case.name, priority == PeriodicServo::Priority::fifo ? 0 : 0.5);
            const RealtimeRun run =
                run_against_the_clock(file, priority, seconds, options.seed, options.output / "realtime.h5");
            const haptics::ServoStatistics& s = run.statistics;
            const std::string name = run.fifo                                    ? "SCHED_FIFO"
                                     : priority == PeriodicServo::Priority::none ? "none"
                                                                                 : "refused";
            const auto pauses = std::ranges::count(run.faults.events(), tick_late, &FaultEvent::fault);
            findings.table +=
                fmt::format("| {} | {} | {:.1f} | {} | {} | {} | {} | {} |\n", patient_case.name, name,
                            seconds / 60, percentiles(s.tick_ns), percentiles(s.wake_latency_ns), s.overruns,
                            pauses, s.ticks - run.recorded);
            runs.push_back({{"case", patient_case.name},
                            {"priority", name},
                            {"ticks", s.ticks},
                            {"recorded", run.recorded},
                            {"counted_as_lost", s.lost_records},
                            {"tick_us", percentiles_json(s.tick_ns, 1e3)},
                            {"wake_latency_us", percentiles_json(s.wake_latency_ns, 1e3)},
                            {"missed", s.overruns},
                            {"pauses", pauses}});
        }
    }
    session.progress.finish();
    findings.result = {{"hogs", hog_count}, {"seed", options.seed}, {"runs", runs}};
    return findings;
}

}  // namespace palpate::experiments
