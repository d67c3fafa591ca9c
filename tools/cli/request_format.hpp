// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

namespace palpate::cli {

class Command;

/// Request files, as the library's configuration files: see Command.
class RequestFormat : public CLI::Config {
  public:
    /// `command` must outlive it.
    explicit RequestFormat(const Command& command) : command_(command) {}

    /// Throws InvalidInput if the stream holds no JSON object, or a key that the command does not know, with
    /// the nearest ones.
    std::vector<CLI::ConfigItem> from_config(std::istream& stream) const override;
    std::string to_config(const CLI::App*, bool, bool, std::string) const override { return ""; }

  private:
    const Command& command_;
};

}  // namespace palpate::cli
