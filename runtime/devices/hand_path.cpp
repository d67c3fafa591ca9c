// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/hand_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>

#include "formats/model/errors.hpp"
#include "runtime/devices/set_orientation.hpp"

namespace palpate::devices {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double unit_tolerance = 1e-9;          // of quaternions in double
constexpr double written_unit_tolerance = 1e-3;  // of those that people write

// The numbers of one row; nothing if something else stands there.
std::optional<std::vector<double>> numbers_of(std::string line) {
    line.erase(std::min(line.find_first_of("#%"), line.size()));
    std::ranges::replace(line, ',', ' ');
    std::istringstream stream(line);
    stream.imbue(std::locale::classic());
    std::vector<double> numbers;
    std::string word;
    while (stream >> word) {
        std::istringstream one(word);
        one.imbue(std::locale::classic());
        double number = 0;
        if (!(one >> number) || one.peek() != EOF || !std::isfinite(number)) return std::nullopt;
        numbers.push_back(number);
    }
    return numbers;
}

// Of four numbers x, y, z, w.
Quaterniond written_orientation(const std::string& where, const double* q) {
    const Quaterniond orientation(q[3], q[0], q[1], q[2]);
    const double norm = orientation.norm();
    if (!(std::abs(norm - 1) <= written_unit_tolerance))
        throw InvalidInput(
            {where, "a quaternion of length " + std::to_string(norm), "1, as qx qy qz qw", ""});
    return orientation.normalized();
}

// In degrees there.
double written_angle(const std::string& where, double degrees) {
    if (!(degrees >= 0 && degrees <= 180))
        throw InvalidInput({where, "a jaw angle of " + std::to_string(degrees), "0 to 180 degrees", ""});
    return degrees * std::numbers::pi / 180;
}

// Calls `take` with what stands where and the numbers, for each row that has some.
void for_each_row(const std::filesystem::path& file, const char* expected,
                  const std::function<void(const std::string& where, const std::vector<double>& row)>& take) {
    std::ifstream stream(file);
    if (!stream) throw InvalidInput({file.string(), "cannot be read", "", "check path and permissions"});
    constexpr std::size_t longest = 1 << 16;  // with the zero that getline() adds
    const auto line = std::make_unique<char[]>(longest);
    for (std::size_t number = 1; stream.getline(line.get(), longest) || stream.gcount() > 0; ++number) {
        const std::string where = file.string() + ", line " + std::to_string(number);
        if (stream.fail())
            throw InvalidInput(
                {where, "more than " + std::to_string(longest - 1) + " characters", expected, ""});
        const auto characters = static_cast<std::size_t>(stream.gcount()) - (stream.eof() ? 0 : 1);
        const auto row = numbers_of({line.get(), characters});
        if (!row) throw InvalidInput({where, "not a finite number", expected, ""});
        if (!row->empty()) take(where, *row);
    }
}

}  // namespace

HandPath::HandPath(std::vector<Key> keys) : keys_(std::move(keys)) {
    if (keys_.empty()) throw InvalidInput({"hand path", "it has no positions", "one or more", ""});
    for (std::size_t i = 0; i < keys_.size(); ++i) {
        const auto refuse = [&](const char* found, const char* expected) {
            throw InvalidInput({"hand path", "key " + std::to_string(i) + found, expected, ""});
        };
        if (!std::isfinite(keys_[i].time) || !keys_[i].position.allFinite() ||
            (i > 0 && keys_[i].time <= keys_[i - 1].time))
            refuse(" is not finite or not later than its predecessor", "finite positions at rising times");
        const bool known = is_known(keys_[i].orientation);
        if (known != is_known(keys_.front().orientation) ||
            (known && !(std::abs(keys_[i].orientation.norm() - 1) <= unit_tolerance)))
            refuse(" has an orientation that is no unit quaternion, or alone has one",
                   "unit quaternions at all keys or at none");
        const bool opened = keys_[i].jaw_angle >= 0;
        if (!std::isfinite(keys_[i].jaw_angle) || opened != (keys_.front().jaw_angle >= 0))
            refuse(" has a jaw angle that is not finite, or alone has one", "angles at all keys or at none");
    }
}

HandPath::Between HandPath::between(double time) const noexcept {
    const auto after = std::ranges::upper_bound(keys_, time, {}, &Key::time);
    if (after == keys_.begin()) return {keys_.front(), keys_.front(), 0};
    const Key& a = *(after - 1);
    if (after == keys_.end()) return {a, a, 0};
    return {a, *after, (time - a.time) / (after->time - a.time)};
}

Vector3d HandPath::at(double time) const noexcept {
    const auto [a, b, part] = between(time);
    return a.position + part * (b.position - a.position);
}

Quaterniond HandPath::orientation_at(double time) const noexcept {
    const auto [a, b, part] = between(time);
    return is_known(a.orientation) ? a.orientation.slerp(part, b.orientation) : a.orientation;
}

double HandPath::jaw_angle_at(double time) const noexcept {
    const auto [a, b, part] = between(time);
    return a.jaw_angle + part * (b.jaw_angle - a.jaw_angle);
}

bool HandPath::holds_at(double time) const noexcept {
    const auto after = std::ranges::upper_bound(keys_, time, {}, &Key::time);
    return after == keys_.begin() ? after->holds : (after - 1)->holds;
}

HandPath mapped_path(const HandPath& path, const Eigen::Isometry3d& X_BA) {
    std::vector<HandPath::Key> keys(path.keys().begin(), path.keys().end());
    const Quaterniond R_BA(X_BA.linear());
    for (HandPath::Key& key : keys) {
        key.position = X_BA * key.position;
        if (is_known(key.orientation)) key.orientation = (R_BA * key.orientation).normalized();
    }
    return HandPath(std::move(keys));
}

HandPath read_hand_path(const std::filesystem::path& file) {
    std::vector<HandPath::Key> keys;
    std::size_t columns = 0;
    constexpr std::array<std::size_t, 5> widths{3, 4, 7, 8, 9};
    for_each_row(file, "x y z (mm) or t x y z (s, mm)", [&](const std::string& where, const auto& row) {
        if (columns == 0 && std::ranges::find(widths, row.size()) != widths.end()) columns = row.size();
        if (row.size() != columns)
            throw InvalidInput({where, std::to_string(row.size()) + " numbers",
                                columns == 0
                                    ? "3 (x y z, mm) or 4 (t x y z, s and mm), or 4 more (qx qy qz qw); of a "
                                      "forceps 9 (t x y z qx qy qz qw and the jaws' angle, degrees)"
                                    : std::to_string(columns) + ", as in the rows before",
                                columns == 0 ? "of a recording of one axis name its --column" : ""});
        HandPath::Key key;
        const bool timed = columns % 4 == 0 || columns == 9;
        const double* p = row.data() + (timed ? 1 : 0);
        key.time = timed ? row.front() : 1e-3 * static_cast<double>(keys.size() + 1);
        key.position = {p[0], p[1], p[2]};
        if (columns > 4) key.orientation = written_orientation(where, p + 3);
        if (columns == 9) key.jaw_angle = written_angle(where, row.back());
        if (!keys.empty() && key.time <= keys.back().time)
            throw InvalidInput({where, "time " + std::to_string(key.time) + " s does not rise",
                                "more than " + std::to_string(keys.back().time) + " s", ""});
        keys.push_back(key);
    });
    if (keys.empty()) throw InvalidInput({file.string(), "it has no positions", "rows of x y z (mm)", ""});
    return HandPath(std::move(keys));
}

std::vector<double> read_column(const std::filesystem::path& file, std::size_t column) {
    std::vector<double> values;
    for_each_row(file, "rows of numbers", [&](const std::string& where, const auto& row) {
        if (column < 1 || column > row.size())
            throw InvalidInput({where, "no column " + std::to_string(column),
                                "1 to " + std::to_string(row.size()), "name another --column"});
        values.push_back(row[column - 1]);
    });
    if (values.empty()) throw InvalidInput({file.string(), "it has no rows", "rows of numbers", ""});
    return values;
}

}  // namespace palpate::devices
