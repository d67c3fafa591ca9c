// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace palpate::imaging {

/// Lets `fill` write so many bytes in a process of its own, for code that may abort, crash or never end.
/// Nothing if it does, throws, returns false or takes more processor time than a minute and a second for each
/// MiB. What it says on stderr is not seen, and what it changes but the bytes is lost. Throws SystemFailure
/// if no process or memory can be had. Cost: some ms.
std::optional<std::vector<char>> filled_apart(std::size_t size,
                                              const std::function<bool(std::span<char>)>& fill);

}  // namespace palpate::imaging
