// SPDX-License-Identifier: Apache-2.0
// A foreign program that tries to read an asset that is not there and reports the error's culprit.
#include <formats/asset/asset.hpp>
#include <formats/model/errors.hpp>
#include <iostream>
#include <runtime/haptics/haptic_model.hpp>

int main() {
    try {
        const palpate::haptics::HapticModel model(palpate::asset::read_asset("absent.vtkhdf"));
    } catch (const palpate::InvalidInput& error) {
        std::cout << error.detail().culprit << '\n';
        return error.detail().culprit == "absent.vtkhdf" ? 0 : 1;
    }
    return 1;
}
