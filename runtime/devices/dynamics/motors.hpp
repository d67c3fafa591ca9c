// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::devices {

/// Motors that warm as they push: their temperature obeys T' = (F² / F_c² - T) / tau with the force or torque
/// F_c that they bear for ever, so that T = 1 is their limit. From there on they are warm, until they have
/// cooled to cool_enough. Realtime-safe.
class Motors {
  public:
    static constexpr double cool_enough = 0.9;  ///< of their limit; a choice

    /// `lasting`: F_c; zero: they stay cool. `step_s`: of warm_up().
    Motors(double lasting, double thermal_time_s, double step_s);

    /// F from now on.
    void push(double amount) noexcept;
    /// A step of time goes by.
    void warm_up() noexcept;
    /// 0 cool, 1 at their limit, and beyond.
    double temperature() const noexcept { return temperature_; }
    bool warm() const noexcept { return warm_; }

  private:
    double lasting_;
    double cooling_;          // what a step leaves of a difference of temperature
    double heating_ = 0;      // F² / F_c²
    double temperature_ = 0;  // T
    bool warm_ = false;
};

}  // namespace palpate::devices
