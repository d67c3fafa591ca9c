// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <limits>
#include <span>
#include <tuple>

#include "formats/records/field.hpp"

namespace palpate::training {

/// Motion and force over one hundredth of a second.
struct Sample {
    double time = 0;                                     ///< s, since the attempt began; pauses do not count
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the hand's device, p_P, mm, averaged
    double force = 0;                                    ///< N, averaged
    double depth = 0;                                    ///< mm, averaged
};

inline constexpr double sample_period = 0.01;  // s
inline constexpr double not_defined = std::numeric_limits<double>::quiet_NaN();

/// What an attempt measures. Not a number: not defined for it.
struct Metrics {
    double score = 0;
    double goals = 0;
    double time = 0;
    double path_length = 0;
    double economy_of_motion = not_defined;
    double log_dimensionless_jerk = not_defined;
    double spectral_arc_length = not_defined;
    double tremor = not_defined;
    double peak_force = 0;
    double mean_force = 0;
    double time_in_contact = 0;
    double time_above_limit = 0;
    double position_error = not_defined;
    double border_error = not_defined;
    double misses = 0;
};

/// Every metric with its definition: result page, files, history and docs visit it.
inline constexpr std::tuple metric_fields{
    Field(
        "score", &Metrics::score, "",
        "0 to 100: 100 times the share of goals, times the share of the time in contact that was within the "
        "force limit"),
    Field("goals", &Metrics::goals, "",
          "share of the goals that were reached; guide: of the gates after the first, at which it begins"),
    Field("time", &Metrics::time, "s", "from start to end, without pauses"),
    Field("path_length", &Metrics::path_length, "mm", "of the hand's way"),
    Field("economy_of_motion", &Metrics::economy_of_motion, "",
          "shortest way through the goals that were reached, over the path length"),
    Field("log_dimensionless_jerk", &Metrics::log_dimensionless_jerk, "",
          "smoothness, higher is smoother: -ln(T^3 / v_peak^2 times the integral of |d2v/dt2|^2) "
          "(Balasubramanian et al. 2015)"),
    Field("spectral_arc_length", &Metrics::spectral_arc_length, "",
          "smoothness, nearer to 0 is smoother: minus the arc length of the speed's spectrum up to 10 Hz "
          "(Balasubramanian et al. 2015)"),
    Field("tremor", &Metrics::tremor, "mm",
          "root mean square of the hand's motion between 6 and 12 Hz (band: Lakie et al. 2015)"),
    Field("peak_force", &Metrics::peak_force, "N", "largest"),
    Field("mean_force", &Metrics::mean_force, "N", "over the time in contact"),
    Field("time_in_contact", &Metrics::time_in_contact, "s", "with at least the least force that counts"),
    Field("time_above_limit", &Metrics::time_above_limit, "s", "with more than the exercise's force limit"),
    Field("position_error", &Metrics::position_error, "mm",
          "touch: mean distance of the touched tissue from its mark; find: of the best mark from the place "
          "above what is hidden; trace: root mean square distance from the line; guide: how near the tool "
          "came to the gates' middles, mean of all but the last, which ends the exercise; retract: of the "
          "forceps from where it was to draw"),
    Field("border_error", &Metrics::border_error, "mm",
          "find: mean distance of the border's marks from the outline of what is hidden, as it is seen from "
          "straight above"),
    Field("misses", &Metrics::misses, "",
          "touch: presses beside the mark; find: marks beside it; trace: departures from the line; guide: "
          "times "
          "the limit was passed; retract: times that tissue slipped out")};

/// Length of the way through the samples, mm.
double path_length(std::span<const Sample> samples);

/// Smoothness of a motion: -ln(T^3 / v_peak^2 integral |d2v/dt2|^2 dt), v the velocity. -5.32 for a straight
/// minimum-jerk reach. Not a number without motion or with less than five samples. Source: Balasubramanian,
/// Melendez-Calderon, Roby-Brami, Burdet 2015, J NeuroEng Rehabil 12:112, eq. 8 (LDLJ-V).
double log_dimensionless_jerk(std::span<const Sample> samples);

/// Smoothness of a motion: minus the arc length of the speed's Fourier magnitude spectrum, normalised by its
/// value at 0, up to the frequency (10 Hz at most) beyond which it stays below 0.05. Zero-padded to 16 times
/// the next power of two. Not a number without motion. Source: the same, eq. 10 (SPARC).
double spectral_arc_length(std::span<const Sample> samples);

/// Root mean square of the motion's part between 6 and 12 Hz, mm: of the positions less the straight line
/// from first to last, by Parseval's theorem. Not a number below one second.
double tremor(std::span<const Sample> samples);

}  // namespace palpate::training
