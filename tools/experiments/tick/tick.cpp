// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/tick/tick.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <optional>

#include "formats/asset/asset.hpp"
#include "formats/drawing/chart.hpp"
#include "runtime/realtime/thread_setup.hpp"
#include "tools/experiments/tick/tick_rigid.hpp"
#include "tools/experiments/tick/tick_soft.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace haptics;
using namespace realtime;
using drawing::Chart;
using drawing::Series;

using Json = nlohmann::ordered_json;

constexpr auto tick_method = R"(# Ticks

What a tick takes, one core, wall clock, us: `HapticModel::tick()`, and its results handed over to logger and window.
Reading the clock twice is in every figure: {} ns here (median). Percentiles are at most 3 % too high. Every path is run {} times, exactly alike, and of each tick the shortest
time counts, so that other processes' share drops out; the last table is of single runs. A bold figure misses its limit. Coupling 0.5 N/mm; friction, where
named, 0.3 at rest and 0.2 sliding. On the bone all ticks of the path count, on soft bodies those that touch.
On the bone the last columns are p50, p99 and p99.9 as multiples of those of CGAL's closest point in the same run.
Points: contact points that bear force, and the nodes of surfaces that these load, mean over the ticks that touch.
Soft bodies are ellipsoids of 3 kPa with semi-axes 30, 30, 20 mm; a sphere goes half its radius deep and slides 4 mm to
either side at 10 mm/s. The published schemes know a point without friction; their collision loop runs 30 times a
virtual second beside the ticks and has rows of its own.

)";

constexpr std::array shares{0.5, 0.99, 0.999};

constexpr auto head =
    "| | ticks | touching | points | nodes loaded | p50 | limit | p99 | p99.9 | limit | max |{}\n"
    "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|{}\n";

double us(const Histogram& times, double fraction) {
    return 1e-3 * static_cast<double>(times.percentile(fraction));
}

std::string number(double us) {
    return fmt::format("{:.{}f}", us, us < 10 ? 2 : 1);
}

std::string limited(double value, double limit) {
    if (!(limit > 0)) return number(value) + " | ";
    return fmt::format(fmt::runtime(value > limit ? "**{}** | {:g}" : "{} | {:g}"), number(value), limit);
}

// p50, p99, p99.9 as multiples of a peer's.
std::array<double, shares.size()> ratios(const Histogram& times, const Histogram& peer) {
    std::array<double, shares.size()> found{};
    for (std::size_t i = 0; i < shares.size(); ++i) found[i] = us(times, shares[i]) / us(peer, shares[i]);
    return found;
}

std::string table_row(const TickRow& row, const Histogram* peer) {
    const std::string counts = row.run.ticks == 0
                                   ? fmt::format("{} | | | ", row.times.count())
                                   : fmt::format("{} | {} | {:.1f} | {:.1f}", row.run.ticks, row.run.touching,
                                                 row.run.pressed, row.run.loaded);
    std::string text = fmt::format("| {} | {} | {} | {} | {} | {} |", row.name, counts,
                                   limited(us(row.times, 0.5), row.limit_p50), number(us(row.times, 0.99)),
                                   limited(us(row.times, 0.999), row.limit_p999), number(us(row.times, 1)));
    if (peer)
        for (const double ratio : ratios(row.times, *peer)) text += fmt::format(" {:.2f} |", ratio);
    return text + '\n';
}

Json json_row(const TickRow& row, const Histogram* peer) {
    Json json{{"group", row.group},
              {"name", row.name},
              {"count", row.times.count()},
              {"p50_us", us(row.times, 0.5)},
              {"p99_us", us(row.times, 0.99)},
              {"p99.9_us", us(row.times, 0.999)},
              {"max_us", 1e-3 * static_cast<double>(row.times.max())}};
    if (row.run.ticks > 0)
        json.update(Json{{"touching", row.run.touching},
                         {"points", row.run.pressed},
                         {"nodes_loaded", row.run.loaded},
                         {"pairs", row.run.pairs},
                         {"cut", row.run.cut},
                         {"unsolved", row.run.unsolved}});
    if (peer) json["times_cgal_closest"] = ratios(row.times, *peer);
    if (row.limit_p50 > 0) json["limit_p50_us"] = row.limit_p50;
    if (row.limit_p999 > 0) json["limit_p99.9_us"] = row.limit_p999;
    return json;
}

// Every 1 ms in a thread of its own, as ServoLoop does, with and without busy threads.
struct LoadRows {
    std::vector<TickRow> rows;
    std::string scheduling;
};

void add_load_rows(LoadRows& found, const std::string& name, HapticModel& model, const HandPath& path,
                   Counted counted, double limit_p50, double limit_p999) {
    constexpr int fifo_priority = 80;
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    for (const unsigned busy : {0U, cores}) {
        const BusyThreads load(busy);
        TickRun run;
        std::thread([&] {
            found.scheduling = request_fifo_priority(fifo_priority).message;
            run = time_paced_ticks(model, {&path, 1}, counted);
        }).join();
        found.rows.push_back({.group = "load",
                              .name = name + (busy == 0 ? ", alone" : fmt::format(", {} busy threads", busy)),
                              .times = run.tick,
                              .run = run,
                              .limit_p50 = limit_p50,
                              .limit_p999 = limit_p999});
    }
}

HandPath first_seconds(const HandPath& path, double seconds) {
    std::vector<HandPath::Key> keys;
    for (int ms = 0; 1e-3 * ms <= std::min(seconds, path.duration()); ++ms)
        keys.push_back({1e-3 * ms, path.at(1e-3 * ms)});
    return HandPath(std::move(keys));
}

// How many ticks take longer than so much.
Series exceedance(const TickRow& row) {
    constexpr std::string_view ours = "continuous, ";
    const std::string name = row.name.starts_with(ours) ? row.name.substr(ours.size()) : row.name;
    Series series{.name = name};
    for (const double share :
         {0.9, 0.75, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4}) {
        series.x.push_back(us(row.times, 1 - share));
        series.y.push_back(100 * share);
    }
    return series;
}

Chart distribution_chart(const std::vector<TickRow>& rows) {
    Chart chart{.title = "On the bone: how many ticks or queries take longer",
                .x_label = "us",
                .y_label = "% of all",
                .log_x = true,
                .log_y = true};
    for (const TickRow& row : rows)
        if (row.name.starts_with("continuous") || row.name.ends_with("CGAL"))
            chart.series.push_back(exceedance(row));
    return chart;
}

Chart contacts_chart(const std::vector<SoftTicks::Point>& points) {
    Chart chart{.title = "On a soft body, without friction",
                .x_label = "nodes loaded",
                .y_label = "us",
                .log_x = false,
                .log_y = true};
    for (const auto& [label, value] :
         {std::pair{"p50", &SoftTicks::Point::p50}, std::pair{"p99.9", &SoftTicks::Point::p999}})
        for (const SoftTicks::Point& point : points) {
            const std::string name = fmt::format("{} nodes, {}", point.nodes, label);
            if (chart.series.empty() || chart.series.back().name != name)
                chart.series.push_back({.name = name});
            chart.series.back().x.push_back(point.loaded);
            chart.series.back().y.push_back(point.*value);
        }
    chart.series.push_back({.name = "limits", .x = {16, 16, 64}, .y = {10, 30, 1000}, .markers = true});
    return chart;
}

// `peer`: CGAL's closest point on the same path, or null.
void add_table(Findings& findings, const std::string& title, const std::vector<TickRow>& rows,
               const Histogram* peer = nullptr) {
    findings.table += "\n## " + title + "\n\n" +
                      fmt::format(head, peer ? " p50 / CGAL | p99 / CGAL | p99.9 / CGAL |" : "",
                                  peer ? "--:|--:|--:|" : "");
    for (const TickRow& row : rows) {
        findings.table += table_row(row, peer);
        findings.result["rows"].push_back(json_row(row, peer));
    }
}

}  // namespace

Findings tick(const Options& options, cli::Session& session) {
    if (options.surfaces.size() != (options.path.empty() ? 0U : 1U))
        throw UsageError({"--surface and --path", "not one of each", "one of each, or neither", ""});
    const double paced_s = options.seconds > 0 ? options.seconds : 5;
    const Histogram clock = clock_cost();
    Findings findings{.result = {{"clock_ns", clock.percentile(0.5)}, {"rows", Json::array()}},
                      .table = fmt::format(tick_method, clock.percentile(0.5), Shortest::passes),
                      .pictures = {}};
    std::vector<Chart> charts;
    LoadRows load;
    if (!options.surfaces.empty()) {
        session.progress.step("bone", 0);
        const TriangleMesh bone = meshing::read_surface(options.surfaces.front());
        const HandPath path = read_hand_path(options.path);
        const RigidTicks rigid = rigid_ticks(bone, path);
        add_table(findings, fmt::format("Bone of {} triangles", bone.triangles.size()), rigid.rows,
                  &rigid.cgal_closest);
        findings.table += fmt::format(
            "\nTo build: OBB tree {:.2f} s (limit 1), queries' copy {:.2f} s; CGAL's tree {:.2f} s. Ticks of "
            "`continuous` with the tool below the surface, once it had been clear: {}.\n",
            rigid.tree_s, rigid.surface_s, rigid.cgal_tree_s, rigid.below);
        findings.result.update(Json{{"obb_tree_s", rigid.tree_s},
                                    {"surface_s", rigid.surface_s},
                                    {"cgal_tree_s", rigid.cgal_tree_s},
                                    {"ticks_below_surface", rigid.below}});
        charts.push_back(distribution_chart(rigid.rows));
        session.progress.step("bone, every 1 ms", 0.1);
        HapticModel model(bone_case(bone, 1, true));
        add_load_rows(load, "bone, 1 mm sphere, friction", model, first_seconds(path, paced_s), Counted::all,
                      2, 15);
    }
    SoftTicks soft = soft_ticks(session);
    for (const auto& file : options.cases) soft.rows.push_back(case_ticks(asset::read_asset(file)));
    add_table(findings, "Soft bodies", soft.rows);
    charts.push_back(contacts_chart(soft.without_friction));
    session.progress.step("soft body, every 1 ms", 0.7);
    HapticModel model(soft.loaded.patient_case);
    add_load_rows(load, "soft body", model, first_seconds(soft.loaded.path, paced_s), Counted::touching, 10,
                  30);
    add_table(findings, "Every 1 ms, alone and with as many busy threads as cores", load.rows);
    findings.table += "\nScheduling of the thread that ticks: " + load.scheduling + ".\n";
    findings.result["scheduling"] = load.scheduling;
    findings.pictures.emplace_back("tick", drawing::charts_svg(charts));
    session.progress.finish();
    return findings;
}

}  // namespace palpate::experiments
