// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/stability/passivity.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>
#include <memory>

#include "formats/drawing/chart.hpp"
#include "runtime/haptics/contact/god_object.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/stability/wall_stability.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using drawing::Chart;
using drawing::Series;

using Json = nlohmann::ordered_json;

constexpr std::array refresh_periods{1, 33};  // ms: 1 kHz, and 30 Hz in whole ticks
constexpr std::array dampings{1e-4, 2.5e-4, 5e-4, 1e-3, 2e-3};
constexpr std::array masses_kg{0.02, 0.045, 0.075};
constexpr double charted_mass_kg = 0.045;
constexpr HandImpedance no_hand{.stiffness = 0, .damping = 0};

constexpr auto passivity_method = R"(## How it was measured

A tip is pressed 2 mm deep into a wall F = K max(0, depth) by a constant load, displaced 1 mm deeper and let go.
The force is refreshed every 1 ms, or every 33 ms (30 Hz) and held between. The loop counts as unstable if, in the
last quarter of 2 000 refreshes, the tip is ever farther from the rest depth than the 1 mm it started with. K rises in steps of 20 % until that happens, and is then bisected to 0.05 %. `2b/T` is the bound of
Colgate and Schenkel with the device's own damping b; `eigenvalue` is where the spectral radius of the sampled
loop's transition matrix passes 1: exact without friction and encoder. `contact` is the same trial with the force
of a HapticModel on a flat plate whose coupling stiffness is K.

)";

// A device of nothing but mass and damping, whose motors never saturate.
DeviceModel classical(double mass_kg, double damping) {
    return {.name = "classical",
            .mass_kg = mass_kg,
            .damping = damping,
            .max_force = std::numeric_limits<double>::infinity()};
}

// The wall as a tool feels it that touches a plate.
Wall contact_wall(double stiffness) {
    constexpr double unlimited = largest_max_force / 2;  // far above what is pressed here
    const HapticSettings settings{.tool_radius = 1,
                                  .coupling_stiffness = stiffness,
                                  .max_force = unlimited,
                                  .max_force_rate = unlimited};
    const auto model = std::make_shared<haptics::HapticModel>(rigid_case("plate", plate_surface(), settings));
    const auto result = std::make_shared<TickResult>();
    const auto force_at = [=](double height) {
        realtime::DeviceState state;
        state.position = {7, 3, height};
        model->tick(state, *result);
        return result->force[2];
    };
    const double touching = settings.tool_radius + haptics::GodObject::skin;
    force_at(touching + 10);  // the contact begins outside
    return [=](double depth) { return force_at(touching - depth); };
}

// A row of how the measured limits compare, over all rows of one period.
std::string comparison(const Json& rows, int period) {
    const auto range = [&](const char* of, const char* against) {
        double least = std::numeric_limits<double>::infinity(), most = 0;
        for (const Json& row : rows) {
            if (row["period_ms"] != period) continue;
            const double ratio = row[of].get<double>() / row[against].get<double>();
            least = std::min(least, ratio);
            most = std::max(most, ratio);
        }
        return fmt::format("{:.3f} … {:.3f}", least, most);
    };
    return fmt::format("| {} | {} | {} | {} |\n", period, range("measured", "two_b_over_t"),
                       range("measured", "eigenvalue"), range("contact", "measured"));
}

Json limits_table(std::string& table, cli::Session& session) {
    table +=
        "## Limits of a mass with damping\n\n"
        "| T ms | m g | b N s/m | measured N/mm | 2b/T N/mm | measured / (2b/T) | eigenvalue N/mm | measured "
        "/ "
        "eigenvalue | contact N/mm |\n|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
    Json rows = Json::array();
    for (const int period : refresh_periods)
        for (const double mass : masses_kg)
            for (const double damping : dampings) {
                session.progress.step("limits", static_cast<double>(rows.size()) / 40);
                const WallLoop loop{classical(mass, damping), no_hand, period};
                const double measured = measured_limit(loop, spring_wall), bound = passivity_limit(loop),
                             exact = eigenvalue_limit(loop), contact = measured_limit(loop, contact_wall);
                table += fmt::format(
                    "| {} | {:g} | {:g} | {:.4g} | {:.4g} | {:.3f} | {:.4g} | {:.4f} | {:.4g} |\n", period,
                    1e3 * mass, 1e3 * damping, measured, bound, measured / bound, exact, measured / exact,
                    contact);
                rows.push_back({{"period_ms", period},
                                {"mass_kg", mass},
                                {"damping", damping},
                                {"measured", measured},
                                {"two_b_over_t", bound},
                                {"eigenvalue", exact},
                                {"contact", contact}});
            }
    table +=
        "\n| T, ms | measured / (2b/T) | measured / eigenvalue | contact / measured |\n|--:|--:|--:|--:|\n";
    for (const int period : refresh_periods) table += comparison(rows, period);
    table +=
        "\nA ratio to 2b/T of 1 or more says that the bound is safe. It grows where damping stops the mass "
        "within "
        "a refresh (m/b < T).\n";
    return rows;
}

struct Effect {
    const char* name;
    void (*apply)(WallLoop&, const DeviceModel& full);
};

constexpr std::array effects{
    Effect{"none", [](WallLoop&, const DeviceModel&) {}},
    Effect{"friction",
           [](WallLoop& l, const DeviceModel& m) { l.model.coulomb_friction = m.coulomb_friction; }},
    Effect{"encoder",
           [](WallLoop& l, const DeviceModel& m) { l.model.encoder_resolution = m.encoder_resolution; }},
    Effect{"one tick of delay", [](WallLoop& l, const DeviceModel&) { l.model.delay_ticks = 1; }},
    Effect{"hand", [](WallLoop& l, const DeviceModel&) { l.hand = HandImpedance{}; }},
    Effect{"friction, encoder and hand",
           [](WallLoop& l, const DeviceModel& m) {
               l.model.coulomb_friction = m.coulomb_friction;
               l.model.encoder_resolution = m.encoder_resolution;
               l.hand = HandImpedance{};
           }},
};

Json effects_table(std::string& table, cli::Session& session) {
    const HandImpedance hand;
    table += fmt::format(
        "\n## What friction, encoder, delay and hand change\n\n"
        "Measured limits, N/mm, each effect alone; in brackets the eigenvalues' where they apply. The hand "
        "is a "
        "spring of {:g} N/mm with {:g} N s/m. What friction adds depends on the deviation of 1 mm: it takes "
        "the "
        "same force from small swings as from large ones.\n\n| device | T ms | 2b/T |",
        hand.stiffness, 1e3 * hand.damping);
    std::string rule = "\n|:--|--:|--:|";
    for (const Effect& effect : effects) {
        table += fmt::format(" {} |", effect.name);
        rule += "--:|";
    }
    table += rule + "\n";
    Json rows = Json::array();
    for (const DeviceModel& model : device_models())
        for (const int period : refresh_periods) {
            session.progress.step("effects", 0.75 + 0.04 * static_cast<double>(rows.size()));
            const WallLoop bare{classical(model.mass_kg, model.damping), no_hand, period};
            table += fmt::format("| {} | {} | {:.3g} |", model.name, period, passivity_limit(bare));
            Json row{{"device", model.name}, {"period_ms", period}, {"two_b_over_t", passivity_limit(bare)}};
            for (const Effect& effect : effects) {
                WallLoop loop = bare;
                effect.apply(loop, model);
                const double measured = measured_limit(loop, spring_wall);
                const bool linear = loop.model.coulomb_friction == 0 && loop.model.encoder_resolution == 0;
                table += linear ? fmt::format(" {:.4g} ({:.4g}) |", measured, eigenvalue_limit(loop))
                                : fmt::format(" {:.4g} |", measured);
                row[effect.name] = measured;
            }
            table += "\n";
            rows.push_back(row);
        }
    return rows;
}

// Below the limit an encoder still keeps the tip moving, unless friction takes what a step of it brings.
Json residual_table(std::string& table) {
    table +=
        "\n## What an encoder leaves at 1 kHz\n\n"
        "How far the tip still swings to either side after 15 s, at half of 2b/T. Friction f takes what a "
        "step d of the encoder brings as long as K < 2 f / d (Abbott, Okamura 2005).\n\n"
        "| device | K N/mm | 2f/d N/mm | encoder alone mm | with friction mm | neither mm |\n"
        "|:--|--:|--:|--:|--:|--:|\n";
    Json rows = Json::array();
    for (const DeviceModel& model : device_models()) {
        WallLoop loop{classical(model.mass_kg, model.damping), no_hand, 1};
        const double stiffness = passivity_limit(loop) / 2;
        const auto residual = [&] {
            return try_wall(loop, stiffness, spring_wall(stiffness), 20000).residual_swing;
        };
        const double neither = residual();
        loop.model.encoder_resolution = model.encoder_resolution;
        const double alone = residual();
        loop.model.coulomb_friction = model.coulomb_friction;
        const double both = residual(), bound = 2 * model.coulomb_friction / model.encoder_resolution;
        table += fmt::format("| {} | {:.3g} | {:.3g} | {:.2g} | {:.2g} | {:.2g} |\n", model.name, stiffness,
                             bound, alone, both, neither);
        rows.push_back({{"device", model.name},
                        {"stiffness", stiffness},
                        {"two_f_over_d", bound},
                        {"encoder_mm", alone},
                        {"encoder_and_friction_mm", both},
                        {"neither_mm", neither}});
    }
    return rows;
}

std::string picture(const Json& limits) {
    Chart chart{.title = fmt::format("Stiffest stable wall, {:g} g", 1e3 * charted_mass_kg),
                .x_label = "damping b [N s/m]",
                .y_label = "stiffness [N/mm]",
                .log_x = true,
                .log_y = true};
    for (const int period : refresh_periods) {
        Series measured{.name = fmt::format("T = {} ms", period), .markers = true};
        Series bound{.name = fmt::format("2b / {} ms", period), .markers = false};
        for (const Json& row : limits) {
            if (row["period_ms"] != period || row["mass_kg"] != charted_mass_kg) continue;
            for (Series* series : {&measured, &bound})
                series->x.push_back(1e3 * row["damping"].get<double>());
            measured.y.push_back(row["measured"]);
            bound.y.push_back(row["two_b_over_t"]);
        }
        for (Series* series : {&measured, &bound}) chart.series.push_back(*series);
    }
    return drawing::charts_svg({chart});
}

}  // namespace

Findings passivity(const Options&, cli::Session& session) {
    Findings findings;
    findings.table = std::string("# The stiffest wall the loop bears\n\n") + passivity_method;
    findings.result["limits"] = limits_table(findings.table, session);
    findings.result["effects"] = effects_table(findings.table, session);
    findings.result["encoder_residuals"] = residual_table(findings.table);
    findings.pictures.emplace_back("passivity", picture(findings.result["limits"]));
    return findings;
}

}  // namespace palpate::experiments
