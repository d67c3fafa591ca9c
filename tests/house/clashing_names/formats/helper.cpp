// SPDX-License-Identifier: Apache-2.0
namespace places {
namespace {

int count(double value) {
    return value > 0 ? 1 : 0;
}

}  // namespace

struct Place {
    double x;
};

int positive(const Place& place) {
    return count(place.x);
}

}  // namespace places
