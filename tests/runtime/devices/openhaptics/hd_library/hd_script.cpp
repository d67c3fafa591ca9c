// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/hd_library/hd_script.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "formats/model/errors.hpp"

namespace palpate::hd {
namespace {

using namespace devices;
using nlohmann::json;

template <class Value>
using Names = std::span<const std::pair<const char*, Value>>;

template <class Value>
Value named(const json& name, Names<Value> names, const std::string& field) {
    std::string known;
    for (const auto& [text, value] : names) {
        if (name == text) return value;
        known += (known.empty() ? "" : ", ") + std::string(text);
    }
    throw InvalidInput({field, name.dump(), known, ""});
}

constexpr std::pair<const char*, Trouble> trouble_names[]{
    {"warm_motors", Trouble::warm_motors},     {"comm_error", Trouble::comm_error},
    {"disconnect", Trouble::disconnect},       {"not_a_number", Trouble::not_a_number},
    {"frozen_pose", Trouble::frozen_pose},     {"max_force", Trouble::max_force},
    {"velocity", Trouble::velocity},           {"impulse", Trouble::impulse},
    {"timer_error", Trouble::timer_error},     {"calibration_lost", Trouble::calibration_lost},
    {"frame_failure", Trouble::frame_failure}, {"scheduler_stall", Trouble::scheduler_stall},
};
constexpr std::pair<const char*, unsigned> refusal_names[]{
    {"comm", comm_error},
    {"comm_config", comm_config_error},
    {"licence", invalid_licence},
    {"already_initiated", already_initiated},
};
constexpr std::pair<const char*, unsigned> rate_refusal_names[]{
    {"value", invalid_value}, {"operation", invalid_operation}, {"timer", timer_error}};
constexpr std::pair<const char*, CalibrationState> calibration_names[]{
    {"ok", calibration_ok},
    {"needs_update", calibration_needs_update},
    {"needs_manual_input", calibration_needs_manual_input}};
constexpr std::pair<const char*, unsigned> style_names[]{
    {"reset", style_reset}, {"auto", style_auto}, {"inkwell", style_inkwell}};
constexpr std::pair<const char*, bool> clock_names[]{{"real", false}, {"virtual", true}};

// A misspelt key must not go unseen.
void check_keys(const json& object, std::initializer_list<const char*> known, const std::string& where) {
    for (const auto& [key, value] : object.items())
        if (std::ranges::find(known, key) == known.end()) throw InvalidInput({where, key, "another key", ""});
}

Span span_of(const json& object) {
    Span span;
    span.from = object.value("from", span.from);
    span.until = object.value("until", span.until);
    return span;
}

HandPath path_of(const json& path) {
    if (path.is_string()) return read_hand_path(path.get<std::string>());
    std::vector<HandPath::Key> keys;
    for (const auto& [t, x, y, z] : path.get<std::vector<std::array<double, 4>>>())
        keys.push_back({t, {x, y, z}});
    return HandPath(std::move(keys));
}

std::optional<HandImpedance> hand_of(const json& hand) {
    if (hand == "rigid") return std::nullopt;
    check_keys(hand, {"stiffness", "damping"}, "hand");
    HandImpedance impedance;
    impedance.stiffness = hand.value("stiffness", impedance.stiffness);
    impedance.damping = hand.value("damping", impedance.damping);
    return impedance;
}

std::array<double, 3> unit(const std::array<double, 3>& direction) {
    const double length = Eigen::Map<const Eigen::Vector3d>(direction.data()).norm();
    if (!(length > 0)) throw InvalidInput({"shaft", "no direction", "three numbers, not all zero", ""});
    return {direction[0] / length, direction[1] / length, direction[2] / length};
}

DeviceScript device_of(const json& object) {
    check_keys(object,
               {"name", "model", "path", "hand", "shaft", "buttons", "inkwell", "calibration", "styles",
                "faults", "refuse"},
               "device");
    DeviceScript device;
    device.name = object.value("name", device.name);
    if (object.contains("model")) device.model = find_device_model(object["model"].get<std::string>());
    if (object.contains("path")) device.path = path_of(object["path"]);
    if (object.contains("hand")) device.hand = hand_of(object["hand"]);
    if (object.contains("shaft")) device.shaft = unit(object["shaft"].get<std::array<double, 3>>());
    for (const json& button : object.value("buttons", json::array())) {
        check_keys(button, {"button", "from", "until"}, "buttons");
        device.buttons.push_back({button.at("button").get<unsigned>() & 31U, span_of(button)});
    }
    device.in_inkwell = object.value("inkwell", false);
    if (object.contains("calibration"))
        device.calibration = named<CalibrationState>(object["calibration"], calibration_names, "calibration");
    if (object.contains("styles")) {
        device.styles = 0;
        for (const json& style : object["styles"])
            device.styles |= named<unsigned>(style, style_names, "styles");
    }
    for (const json& fault : object.value("faults", json::array())) {
        check_keys(fault, {"fault", "from", "until"}, "faults");
        device.troubles.push_back(
            {named<Trouble>(fault.at("fault"), trouble_names, "faults"), span_of(fault)});
    }
    if (object.contains("refuse"))
        device.refusal = named<unsigned>(object["refuse"], refusal_names, "refuse");
    return device;
}

}  // namespace

Script parse_script(const std::string& text) try {
    const json object = json::parse(text);
    check_keys(object, {"clock", "pause_after_ticks", "rate_hz", "rate_refusal", "devices"}, "script");
    Script script;
    if (object.contains("clock")) script.virtual_clock = named<bool>(object["clock"], clock_names, "clock");
    script.pause_after_ticks = object.value("pause_after_ticks", script.pause_after_ticks);
    script.rate_hz = object.value("rate_hz", script.rate_hz);
    if (script.rate_hz != 500 && script.rate_hz != 1000)
        throw InvalidInput({"rate_hz", std::to_string(script.rate_hz), "500 or 1000", ""});
    if (object.contains("rate_refusal"))
        script.rate_refusal = named<unsigned>(object["rate_refusal"], rate_refusal_names, "rate_refusal");
    if (object.contains("devices")) {
        script.devices.clear();
        for (const json& device : object["devices"]) script.devices.push_back(device_of(device));
    }
    return script;
} catch (const json::exception& error) {
    throw InvalidInput({"script", error.what(), "JSON as in README.md", ""});
}

}  // namespace palpate::hd
