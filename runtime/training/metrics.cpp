// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/metrics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace palpate::training {
namespace {

using Eigen::Vector3d;
using Spectrum = std::vector<std::complex<double>>;

std::vector<Vector3d> velocities(std::span<const Sample> samples) {
    std::vector<Vector3d> result;
    for (std::size_t i = 1; i < samples.size(); ++i)
        result.push_back((samples[i].position - samples[i - 1].position) / sample_period);
    return result;
}

Spectrum spectrum_of(const std::vector<double>& values) {
    Spectrum spectrum;
    Eigen::FFT<double> transform;
    transform.fwd(spectrum, values);
    return spectrum;
}

}  // namespace

double path_length(std::span<const Sample> samples) {
    double length = 0;
    for (std::size_t i = 1; i < samples.size(); ++i)
        length += (samples[i].position - samples[i - 1].position).norm();
    return length;
}

double log_dimensionless_jerk(std::span<const Sample> samples) {
    const std::vector<Vector3d> v = velocities(samples);
    if (v.size() < 4) return not_defined;
    double peak = 0, integral = 0;
    for (const Vector3d& velocity : v) peak = std::max(peak, velocity.norm());
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        const Vector3d jerk = (v[i + 1] - 2 * v[i] + v[i - 1]) / (sample_period * sample_period);
        integral += jerk.squaredNorm() * sample_period;
    }
    if (peak <= 0 || integral <= 0) return not_defined;
    const double duration = static_cast<double>(v.size()) * sample_period;
    return -std::log(duration * duration * duration / (peak * peak) * integral);
}

double spectral_arc_length(std::span<const Sample> samples) {
    constexpr double highest = 10, least_share = 0.05;  // Hz, of the spectrum's value at 0
    constexpr std::size_t padding = 16;
    std::vector<double> speed;
    for (const Vector3d& velocity : velocities(samples)) speed.push_back(velocity.norm());
    if (speed.size() < 2) return not_defined;
    speed.resize(padding * std::bit_ceil(speed.size()), 0);
    const Spectrum spectrum = spectrum_of(speed);
    const double at_zero = std::abs(spectrum[0]);
    if (at_zero <= 0) return not_defined;
    const double step = 1 / (static_cast<double>(speed.size()) * sample_period);  // Hz
    const auto magnitude = [&](std::size_t i) { return std::abs(spectrum[i]) / at_zero; };
    std::size_t last = std::min(static_cast<std::size_t>(highest / step), spectrum.size() / 2);
    while (last > 0 && magnitude(last) < least_share) --last;
    double length = 0;
    for (std::size_t i = 1; i <= last; ++i)
        length += std::hypot(1 / static_cast<double>(last), magnitude(i) - magnitude(i - 1));
    return -length;
}

double tremor(std::span<const Sample> samples) {
    constexpr double lowest = 6, highest = 12;  // Hz
    const std::size_t count = samples.size();
    const double duration = static_cast<double>(count) * sample_period;
    if (duration < 1) return not_defined;
    double mean_square = 0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        const double first = samples.front().position[axis], last = samples.back().position[axis];
        for (std::size_t i = 0; i < count; ++i)
            values.push_back(samples[i].position[axis] - first -
                             (last - first) * static_cast<double>(i) / static_cast<double>(count - 1));
        const Spectrum spectrum = spectrum_of(values);
        for (std::size_t i = 1; 2 * i < count; ++i) {
            const double frequency = static_cast<double>(i) / duration;
            if (frequency >= lowest && frequency <= highest)
                mean_square += 2 * std::norm(spectrum[i]) / static_cast<double>(count * count);
        }
    }
    return std::sqrt(mean_square);
}

}  // namespace palpate::training
