// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace CLI {
class Option;  // CLI11, whose headers stay in tools/cli
}

namespace palpate::cli {

/// CLI11's check of a number above 0: what is wrong with a text, empty if nothing is.
std::string positive_number(const std::string& text);

/// One option of a command: a handle, as cheap to copy as a pointer, valid as long as its Command. The rules
/// that it is given are checked when the command line is read; what breaks one is told and ends in exit
/// code 2.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required() const;
    Option needs(Option other) const;
    Option excludes(Option other) const;
    Option range(int least, int most) const;
    Option range(double least, double most) const;
    Option positive() const;
    Option non_negative() const;
    Option one_of(std::vector<std::string> words) const;
    /// What the help gives as the default, where the variable's content is not it: a value that the option
    /// takes, for 3D Slicer passes it. What is no value belongs into the help, as "[default: all cores]".
    Option shown_default(const std::string& text) const;
    /// Takes one value each time it is given, so that the next word may be a positional one; values may also
    /// be parted by `delimiter`, unless that is 0.
    Option one_value_each(char delimiter = 0) const;

    /// Whether the command line has it.
    bool given() const;
    /// Its first name, as in "--threads".
    std::string name() const;
    /// The words that it was given.
    std::vector<std::string> words() const;

    /// The library's own, for tools/cli.
    const CLI::Option& handle() const { return *option_; }

    friend bool operator==(Option, Option) = default;

  private:
    CLI::Option* option_;
};

}  // namespace palpate::cli
