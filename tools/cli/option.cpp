// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/option.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <utility>

namespace palpate::cli {

std::string positive_number(const std::string& text) {
    return std::strtod(text.c_str(), nullptr) > 0 ? "" : text + " is not a positive number";
}

Option Option::required() const {
    return Option(option_->required());
}

Option Option::needs(Option other) const {
    return Option(option_->needs(other.option_));
}

Option Option::excludes(Option other) const {
    return Option(option_->excludes(other.option_));
}

Option Option::range(int least, int most) const {
    return Option(option_->check(CLI::Range(least, most)));
}

Option Option::range(double least, double most) const {
    return Option(option_->check(CLI::Range(least, most)));
}

Option Option::positive() const {
    return Option(option_->check(positive_number, "POSITIVE"));
}

Option Option::non_negative() const {
    return Option(option_->check(CLI::NonNegativeNumber));
}

Option Option::one_of(std::vector<std::string> words) const {
    return Option(option_->check(CLI::IsMember(std::move(words))));
}

Option Option::shown_default(const std::string& text) const {
    return Option(option_->default_str(text));
}

Option Option::one_value_each(char delimiter) const {
    if (delimiter != 0) option_->delimiter(delimiter);
    return Option(option_->allow_extra_args(false));
}

bool Option::given() const {
    return option_->count() > 0;
}

std::string Option::name() const {
    return option_->get_name();
}

std::vector<std::string> Option::words() const {
    return option_->results();
}

}  // namespace palpate::cli
