// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace palpate::visual {

/// A place in the scene that an exercise points at.
struct LessonMark {
    enum class State { waiting, due, done, truth };
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< p_P, mm
    double radius = 2;                                ///< mm
    State state = State::waiting;                     ///< truth: what a search was for, shown afterwards
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();   ///< of a gate, drawn as a ring about it; zero: a ball

    bool operator==(const LessonMark&) const = default;
};

/// A small picture of the scene with an exercise's marks, from near enough to see them; without any, the
/// first view.
struct LessonPicture {
    std::vector<LessonMark> marks{};
    std::vector<Eigen::Vector3d> line{};  ///< p_P, mm
    double line_radius = 0.5;             ///< mm
    bool whole = false;                   ///< the whole case, from outside

    bool operator==(const LessonPicture&) const = default;
};

/// A line of a page that can be chosen, by its key or with the mouse.
struct LessonChoice {
    std::string key;                         ///< X11 name, lower case: "1", "return"
    std::string text;                        ///< with the key as people call it
    std::optional<LessonPicture> picture{};  ///< beside it; such choices stand together, before the others
};

/// A curve on a page.
struct LessonCurve {
    std::string title, x_title, y_title;
    std::vector<double> x, y;
    std::optional<double> limit{};   ///< a horizontal line
    std::optional<double> most_y{};  ///< the axis goes from 0 to it; as the values are if not given
    bool points = false;             ///< a dot for every value, which are numbered from 1, in place of a line
};

/// A page over the scene: between exercises, before the first, after each.
struct LessonPage {
    std::string title, text;
    std::vector<std::pair<std::string, std::string>> rows;  ///< names and values
    std::vector<LessonCurve> curves;                        ///< two at most
    std::vector<LessonChoice> choices;
    std::optional<LessonPicture> picture{};  ///< beside the title
};

/// What the window shows of an exercise.
struct LessonView {
    std::string instruction;  ///< over the scene, as are the next two; empty: none
    std::string status;
    std::string warning;
    std::vector<LessonChoice> actions;       ///< what can be done now, as buttons below the scene
    double least_force = 0, most_force = 0;  ///< N: the band that the force is to keep to; 0, 0: none
    std::optional<double> press_force;       ///< N: what a press by the mouse is to make
    bool hides_regions = false;              ///< what bodies enclose must not be seen
    std::vector<LessonMark> marks;
    std::vector<Eigen::Vector3d> line, line_done;  ///< p_P, mm
    double line_radius = 0.5;                      ///< mm
    std::vector<Eigen::Vector3d> outline;    ///< closed: of what a search is for, shown afterwards, p_P, mm
    std::optional<Eigen::Vector3d> look_at;  ///< by the endoscope, p_P, mm
    std::vector<Eigen::Vector3d> path;       ///< the hand's way, shown afterwards, p_P, mm
    std::optional<LessonPage> page;
    bool takes_keys = false;  ///< every key goes to the page as X11 names it, none to the window
};

}  // namespace palpate::visual
