// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace places {

struct Place {
    int row;
};

int count(const Place& place);

}  // namespace places
