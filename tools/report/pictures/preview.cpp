// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/preview.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "tools/meshing/measures/quality.hpp"
#include "tools/report/pictures/picture.hpp"
#include "tools/report/pictures/scene.hpp"
#include "tools/report/pictures/slice_targets.hpp"

namespace palpate::report {
namespace {

constexpr Rgb page_colour{246, 248, 250}, ink{28, 33, 40}, on_dark{255, 255, 255};
constexpr int gap = 12, line = 24, letters = 15;  // pixels

struct LegendRow {
    Label label;
    std::string words;
};

int legend_columns(int width) {
    return std::max(1, width / 420);
}

int legend_height(std::size_t rows, int width) {
    const int columns = legend_columns(width);
    return gap + line * ((static_cast<int>(rows) + columns - 1) / columns);
}

void draw_legend(Picture& page, int top, const std::vector<LegendRow>& rows) {
    const int columns = legend_columns(page.width),
              lines = (static_cast<int>(rows.size()) + columns - 1) / columns;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const int x = gap + static_cast<int>(n) / lines * (page.width / columns),
                  y = top + static_cast<int>(n) % lines * line;
        fill(page, x, y, letters, letters, rgb_of(rows[n].label.colour));
        write_words(page, x + 2 * gap, y, rows[n].label.name + "   " + rows[n].words, letters, ink);
    }
}

// At the lower left corner of a picture.
void draw_scale(Picture& picture, double mm_per_pixel, const Rgb& colour) {
    const double length = scale_bar_length(mm_per_pixel * picture.width);
    fill(picture, gap, picture.height - gap, static_cast<int>(length / mm_per_pixel), 3, colour);
    write_words(picture, gap, picture.height - gap - line + 2, fmt::format("{:g} mm", length), letters,
                colour);
}

Picture slice_with_words(const SliceTarget& target, Plane plane, const Volume* volume, const LabelMap& map,
                         const GreyWindow& grey) {
    const PlaneText text = plane_text(plane);
    SliceWindow window{.plane = plane, .center = target.center, .side = target.side, .pixels = 400};
    window.center[text.axis] = target.planes[text.axis];
    Picture picture = slice_picture(window, volume, &map, grey);
    const int n = window.pixels;
    write_words(picture, gap, gap / 2,
                fmt::format("{}, {} = {:.1f} mm", text.title, text.higher, target.planes[text.axis]), letters,
                on_dark);
    write_words(picture, gap / 2, n / 2, text.left, letters, on_dark);
    write_words(picture, n - 2 * gap + 4, n / 2, text.right, letters, on_dark);
    write_words(picture, n / 2, line + 4, text.top, letters, on_dark);
    write_words(picture, n / 2, n - line, text.bottom, letters, on_dark);
    draw_scale(picture, window.side / n, on_dark);
    return picture;
}

}  // namespace

std::string label_preview_png(const LabelMap& map, const Volume* volume) {
    constexpr std::size_t most = 8;
    constexpr int side = 400, width = 3 * side + 4 * gap, row_height = line + side + gap;
    const GreyWindow grey = volume ? grey_window(*volume) : GreyWindow{};
    std::vector<SliceTarget> targets = label_targets(map);
    std::vector<std::int64_t> voxels(65536, 0);
    for (const std::uint16_t label : map.labels) ++voxels[label];
    std::vector<LegendRow> rows;
    for (const Label& label : map.names)
        if (const auto count = static_cast<double>(voxels[label.value]); count > 0)
            rows.push_back({label, fmt::format("{:.1f} ml", count * map.grid.voxel_volume() / 1000)});
    const bool several = targets.size() > 1;
    targets.resize(std::min(targets.size(), most));
    if (several) targets.insert(targets.begin(), whole_target(map));

    Picture page =
        blank(width, static_cast<int>(targets.size()) * row_height + legend_height(rows.size(), width) + gap,
              page_colour);
    draw_legend(page, gap, rows);
    int y = legend_height(rows.size(), width);
    for (const SliceTarget& target : targets) {
        write_words(page, gap, y + 4, target.name, letters, ink);
        int x = gap;
        for (const Plane plane : {Plane::axial, Plane::coronal, Plane::sagittal}) {
            paste(page, slice_with_words(target, plane, volume, map, grey), x, y + line);
            x += side + gap;
        }
        y += row_height;
    }
    return png_bytes(page);
}

std::string mesh_preview_png(const TetMesh& mesh) {
    const std::vector<ViewDirection> sides{{-0.7, -1, 0.45}, {0.85, 0.75, 0.4}},
        cuts{{0, -1, 0.02}, {-1, 0, 0.02}};
    const PictureWindow window;
    std::vector<SceneView> views = mesh_pictures(window, mesh, sides, false);
    for (SceneView& view : mesh_pictures(window, mesh, cuts, true)) views.push_back(std::move(view));
    const std::vector<std::string> words{"from the right, front and above", "from the left, back and above",
                                         "cut open, from the front", "cut open, from the right"};
    const meshing::EdgeLengths edges = meshing::edge_lengths(mesh);
    std::vector<LegendRow> rows;
    for (const Label& label : mesh.region_names)
        rows.push_back({label, fmt::format("{} tetrahedra", std::ranges::count(mesh.regions, label.value))});

    const int width = views.front().picture.width, height = views.front().picture.height;
    const int page_width = 2 * width + 3 * gap, top = legend_height(rows.size(), page_width) + line;
    Picture page = blank(page_width, top + 2 * (height + line + gap), page_colour);
    write_words(page, gap, gap / 2,
                fmt::format("{} tetrahedra, edges {:.2g} to {:.2g} mm, {:.2g} mm on average",
                            mesh.tetrahedra.size(), edges.shortest, edges.longest, edges.mean),
                letters, ink);
    draw_legend(page, gap + line, rows);
    for (std::size_t n = 0; n < views.size(); ++n) {
        const int x = gap + static_cast<int>(n % 2) * (width + gap),
                  y = top + static_cast<int>(n / 2) * (height + line + gap);
        draw_scale(views[n].picture, views[n].mm_per_pixel, ink);
        write_words(page, x, y + 4, words[n], letters, ink);
        paste(page, views[n].picture, x, y + line);
    }
    return png_bytes(page);
}

}  // namespace palpate::report
