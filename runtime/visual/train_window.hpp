// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/visual/controls/open_window.hpp"
#include "runtime/visual/detail/detail.hpp"
#include "runtime/visual/playback/film.hpp"
#include "runtime/visual/sight.hpp"
#include "runtime/visual/visual_frame.hpp"

namespace palpate::visual {

struct WindowSettings {
    std::int64_t rigid_budget = 60'000;               ///< triangles of all rigid bodies on the screen
    Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< where the hand is first, p_P, mm
    Sight sight{};                                    ///< where the eye is first
    std::vector<std::string> cautions{};              ///< what a certificate does not say of the case
    /// How mouse and keyboard hold a tool that turns first, R_PT; nothing: they turn none.
    std::optional<Eigen::Quaterniond> orientation{};
    /// Of a forceps (mm), which a drag of the mouse carries where it would press another tool in.
    std::optional<double> jaw_length{};
    std::optional<double> rendered{};  ///< as of felt_text()
    /// The bodies' rest surfaces, as in HapticModel: what the pointer touches. They outlive the window.
    std::vector<const collision::CollisionSurface*> surfaces{};
};

/// The trainer's window: draws the scene and turns mouse and keyboard into a place for the hand. One thread,
/// the one that made it; it never waits for another.
class TrainWindow {
  public:
    /// Draws in a window of its own from now on.
    TrainWindow(std::shared_ptr<OpenedWindow> opened, const Case& patient_case,
                const WindowSettings& settings);
    TrainWindow(const TrainWindow&) = delete;
    TrainWindow& operator=(const TrainWindow&) = delete;
    ~TrainWindow();

    /// Handles what mouse and keyboard did, then draws one frame.
    void show(const VisualFrame& frame);

    bool closed() const;           ///< Q, Escape or the window's own button
    bool lost() const;             ///< its display went away, or another program took it
    void require_display() const;  ///< throws SystemFailure if it is lost
    Eigen::Vector3d hand() const;  ///< where the hand is meant to be, p_P, mm
    /// How the hand is meant to hold a tool that mouse and keyboard turn, R_PT; zero of others.
    Eigen::Quaterniond held_orientation() const;
    /// Moves the hand there (p_P, mm), as far as mouse and keyboard hold one.
    void place_hand(const Eigen::Vector3d& place);
    /// Says something on the screen for a few seconds.
    void tell(const std::string& sentence);
    /// The keys that were pressed since the last call, by hand or by a click on a button or a page's choice:
    /// X11 names in lower case. What is the window's own has been done already.
    std::vector<std::string> take_keys();
    /// Where the timeline was clicked last since the last call, 0 ... 1.
    std::optional<double> take_sought();
    std::int64_t frames() const;       ///< drawn so far
    double frames_per_second() const;  ///< of the last second or so
    ShownDetail detail() const;

    /// Writes what the window shows as PNG. Throws SystemFailure if that fails.
    void save_picture(const std::filesystem::path& path);
    /// Adds what the window shows to a film. Throws as Film::add().
    void add_to(Film& film);

  private:
    struct Parts;
    void draw(const VisualFrame& frame);

    std::unique_ptr<Parts> parts_;
};

}  // namespace palpate::visual
