// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "formats/model/errors.hpp"

namespace palpate::test {

/// The message of the error of type `Refusal` that `call` throws, or a text that is none.
template <typename Refusal = InvalidInput, typename Call>
std::string refusal_of(Call&& call) {
    try {
        call();
    } catch (const Refusal& error) {
        return error.what();
    }
    return "nothing was refused";
}

}  // namespace palpate::test
