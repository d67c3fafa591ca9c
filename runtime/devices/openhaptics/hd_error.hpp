// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "formats/model/errors.hpp"
#include "formats/records/fault.hpp"
#include "runtime/devices/openhaptics/hd_api.hpp"

namespace palpate::devices {

/// What is said of an HDAPI error code.
struct HdErrorText {
    unsigned code;
    const char* name;   ///< as in HDAPI
    const char* cause;  ///< what has happened
    const char* fix;    ///< what the user does about it
    Fault fault;        ///< what it is to the servo; no_fault: the force may stay
};

/// Every error code of HDAPI, by rising code.
std::span<const HdErrorText> hd_error_texts();

/// Finds the text of `code`; nullptr if HDAPI has no such code. Realtime-safe.
const HdErrorText* find_hd_error(unsigned code) noexcept;

/// Says of `error`, which `culprit` met, cause and fix.
ErrorDetail explain_hd_error(const std::string& culprit, const HdErrorInfo& error);

/// Gives up to empty an error stack after so many: of a driver that has lost its device it may never end.
inline constexpr int most_hd_errors = 32;

/// Empties the driver's error stack and returns its first entry, which HDAPI has as the latest; code 0 if
/// there is none. Realtime-safe.
HdErrorInfo take_hd_errors(const HdApi& api) noexcept;

/// Sorts what the driver's error stack says by device: errors name their device, and one device's may come
/// up during calls that are for another. Realtime-safe, but for add(); the servo's thread alone.
class HdErrorSorter {
  public:
    explicit HdErrorSorter(const HdApi& api) noexcept : api_(api) {}
    static constexpr std::size_t most_devices = 8;

    /// From now on errors about `device` are kept for it. Throws InvalidInput beyond most_devices.
    void add(HdHandle device);
    /// Empties the stack. An error about no known device is kept for all.
    void drain() noexcept;
    /// The Fault flags of the errors about `device` since this was last called for it.
    std::uint32_t take(HdHandle device) noexcept;

  private:
    struct Kept {
        HdHandle device = hdapi::invalid_handle;
        std::uint32_t faults = no_fault;
    };
    const HdApi& api_;
    std::array<Kept, most_devices> kept_;
    std::size_t count_ = 0;
};

}  // namespace palpate::devices
