// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/view_svg.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "tools/meshing/measures/quality.hpp"
#include "tools/report/html.hpp"

namespace palpate::report {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The patient's axes as the reader sees them; each shows the end that points to the reader.
std::string orientation_svg(const ViewDirection& direction, const Vector2d& at) {
    const Vector3d to_eye = direction.normalized();
    const Vector3d right = Vector3d::UnitZ().cross(to_eye).normalized(), up = to_eye.cross(right);
    constexpr double length = 40;
    const std::array<std::array<const char*, 2>, 3> letters{{{"L", "R"}, {"P", "A"}, {"S", "I"}}};
    std::string svg;
    for (int axis = 0; axis < 3; ++axis) {
        Vector3d end = Vector3d::Unit(axis);
        const bool turned = axis != 2 && end.dot(to_eye) < 0;
        if (turned) end = -end;
        const Vector2d tip(end.dot(right), -end.dot(up));
        const Vector2d line = at + length * tip, letter = at + (length + 14) * tip;
        svg += fmt::format(
            "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
            "text-anchor=\"middle\">{}</text>",
            at.x(), at.y(), line.x(), line.y(), letter.x(), letter.y() + 7, letters[axis][turned]);
    }
    return svg;
}

// The place on an edge that is farthest from the texts already there, and from the middle if that is all the
// same.
Vector2d free_place(const Vector2d& a, const Vector2d& b, const std::vector<Vector2d>& taken) {
    constexpr double wide = 3;  // a text is that much wider than high
    Vector2d best = (a + b) / 2;
    double best_room = -1;
    for (const double part : {0.5, 0.35, 0.65, 0.25, 0.75}) {
        const Vector2d place = a + part * (b - a);
        double room = 30;  // more is no better
        for (const Vector2d& other : taken)
            room = std::min(room, std::hypot((place.x() - other.x()) / wide, place.y() - other.y()));
        if (room <= best_room) continue;
        best_room = room;
        best = place;
    }
    return best;
}

}  // namespace

std::string view_svg(const SceneView& view, const ViewDirection& direction, const std::string& description,
                     const std::vector<std::string>& mark_names) {
    std::string svg = fmt::format(
        "<svg class=\"view\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\"><image width=\"{0}\" "
        "height=\"{1}\" href=\"{3}\"/>",
        view.picture.width, view.picture.height, html::escaped(description),
        html::data_uri("image/png", png_bytes(view.picture)));
    svg += orientation_svg(direction, {70, view.picture.height - 60.0});
    for (std::size_t i = 0; i < view.marks.size() && i < mark_names.size(); ++i) {
        const Vector2d& p = view.marks[i];
        const bool near_edge = p.x() > view.picture.width - 60;
        svg += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\"/><text class=\"mark\" x=\"{:.1f}\" y=\"{:.1f}\" "
            "text-anchor=\"{}\">{}</text>",
            p.x(), p.y(), p.x() + (near_edge ? -13 : 13), p.y() - 8, near_edge ? "end" : "start",
            html::escaped(mark_names[i]));
    }
    return svg + "</svg>";
}

std::string tetrahedron_svg(const TetMesh& mesh, std::size_t t, const Label& region) {
    constexpr double size = 300, drawn = 190;
    Eigen::Matrix<double, 3, 4> p;
    for (std::size_t c = 0; c < 4; ++c)
        p.col(static_cast<Eigen::Index>(c)) = mesh.rest_positions[mesh.tetrahedra[t][c]];
    p.colwise() -= p.rowwise().mean().eval();
    // Widest across the two longest principal axes; a little tilted, so that flat ones show their depth.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(p * p.transpose());
    const Vector3d right = axes.eigenvectors().col(2);
    const Vector3d to_eye = (axes.eigenvectors().col(0) + 0.3 * axes.eigenvectors().col(1)).normalized();
    const Vector3d up = to_eye.cross(right).normalized();
    std::array<Vector2d, 4> q;
    Vector2d low = Vector2d::Constant(1e300), high = -low;
    for (std::size_t c = 0; c < 4; ++c) {
        const Vector3d corner = p.col(static_cast<Eigen::Index>(c));
        q[c] = {right.dot(corner), -up.dot(corner)};
        low = low.cwiseMin(q[c]);
        high = high.cwiseMax(q[c]);
    }
    const double scale = drawn / (high - low).maxCoeff();
    for (Vector2d& corner : q) corner = Vector2d::Constant(size / 2) + scale * (corner - (low + high) / 2);

    std::array<bool, 4> faces_eye{};
    std::string faces, edges, angles;
    for (std::size_t f = 0; f < 4; ++f) {
        const auto& [a, b, c] = tetrahedron_faces[f];
        const auto corner = [&](std::size_t i) -> Vector3d { return p.col(static_cast<Eigen::Index>(i)); };
        faces_eye[f] = (corner(b) - corner(a)).cross(corner(c) - corner(a)).dot(to_eye) > 0;
        if (faces_eye[f])
            faces += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z", q[a].x(), q[a].y(), q[b].x(),
                                 q[b].y(), q[c].x(), q[c].y());
    }
    const meshing::TetShape shape = meshing::tet_shape(mesh, t);
    std::vector<Vector2d> taken;
    const auto [sharpest, bluntest] = std::ranges::minmax(shape.dihedral_deg);
    std::size_t edge = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j, ++edge) {
            // The faces opposite to corners i and j are those whose angle is `edge`; they meet in the other
            // two.
            std::array<std::size_t, 2> ends{};
            std::size_t n = 0;
            for (std::size_t c = 0; c < 4; ++c)
                if (c != i && c != j) ends[n++] = c;
            const Vector2d &a = q[ends[0]], &b = q[ends[1]];
            edges += fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>",
                                 faces_eye[i] || faces_eye[j] ? "edge" : "edge hidden", a.x(), a.y(), b.x(),
                                 b.y());
            const Vector2d place = free_place(a, b, taken);
            taken.push_back(place);
            const double angle = shape.dihedral_deg[edge];
            angles += fmt::format(
                "<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.1f}°</text>",
                angle == sharpest || angle == bluntest ? "angle worst" : "angle", place.x(), place.y() + 5,
                angle);
        }
    return fmt::format(
        "<svg class=\"tetrahedron\" viewBox=\"0 0 {0} {0}\" role=\"img\" aria-label=\"tetrahedron {1}\">"
        "<path d=\"{2}\" fill=\"rgb({3:.0f},{4:.0f},{5:.0f})\"/>{6}{7}</svg>",
        size, t, faces, 255 * region.colour[0], 255 * region.colour[1], 255 * region.colour[2], edges,
        angles);
}

}  // namespace palpate::report
