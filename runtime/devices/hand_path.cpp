// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/hand_path.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate::devices {
namespace {

using Eigen::Vector3d;

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

// Calls `take` with what stands where and the numbers, for each row that has some.
void for_each_row(const std::filesystem::path& file, const char* expected,
                  const std::function<void(const std::string& where, const std::vector<double>& row)>& take) {
    std::ifstream stream(file);
    if (!stream) throw InvalidInput({file.string(), "cannot be read", "", "check path and permissions"});
    std::string line;
    for (std::size_t number = 1; std::getline(stream, line); ++number) {
        const std::string where = file.string() + ", line " + std::to_string(number);
        const auto row = numbers_of(line);
        if (!row) throw InvalidInput({where, "not a finite number", expected, ""});
        if (!row->empty()) take(where, *row);
    }
}

}  // namespace

HandPath::HandPath(std::vector<Key> keys) : keys_(std::move(keys)) {
    if (keys_.empty()) throw InvalidInput({"hand path", "it has no positions", "one or more", ""});
    for (std::size_t i = 0; i < keys_.size(); ++i)
        if (!std::isfinite(keys_[i].time) || !keys_[i].position.allFinite() ||
            (i > 0 && keys_[i].time <= keys_[i - 1].time))
            throw InvalidInput({"hand path",
                                "key " + std::to_string(i) +
                                    " is not finite or not later than its "
                                    "predecessor",
                                "finite positions at rising times", ""});
}

Vector3d HandPath::at(double time) const noexcept {
    const auto after = std::ranges::upper_bound(keys_, time, {}, &Key::time);
    if (after == keys_.begin()) return keys_.front().position;
    if (after == keys_.end()) return keys_.back().position;
    const Key& a = *(after - 1);
    const double part = (time - a.time) / (after->time - a.time);
    return a.position + part * (after->position - a.position);
}

bool HandPath::holds_at(double time) const noexcept {
    const auto after = std::ranges::upper_bound(keys_, time, {}, &Key::time);
    return after == keys_.begin() ? after->holds : (after - 1)->holds;
}

HandPath mapped_path(const HandPath& path, const Eigen::Isometry3d& X_BA) {
    std::vector<HandPath::Key> keys(path.keys().begin(), path.keys().end());
    for (HandPath::Key& key : keys) key.position = X_BA * key.position;
    return HandPath(std::move(keys));
}

HandPath read_hand_path(const std::filesystem::path& file) {
    std::vector<HandPath::Key> keys;
    std::size_t columns = 0;
    for_each_row(file, "x y z (mm) or t x y z (s, mm)", [&](const std::string& where, const auto& row) {
        if (columns == 0 && (row.size() == 3 || row.size() == 4)) columns = row.size();
        if (row.size() != columns)
            throw InvalidInput({where, std::to_string(row.size()) + " numbers",
                                columns == 0 ? "3 (x y z, mm) or 4 (t x y z, s and mm)"
                                             : std::to_string(columns) + ", as in the rows before",
                                columns == 0 ? "of a recording of one axis name its --column" : ""});
        HandPath::Key key;
        key.time = columns == 4 ? row.front() : 1e-3 * static_cast<double>(keys.size() + 1);
        key.position = {row[columns - 3], row[columns - 2], row[columns - 1]};
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
