// SPDX-License-Identifier: Apache-2.0
#include "formats/places.hpp"

namespace places {

int twice(const Place& place) {
    return 2 * count(place);
}

}  // namespace places
