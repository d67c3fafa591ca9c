// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/charts.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "tools/report/html.hpp"

namespace palpate::report {

using html::escaped;

std::string histogram_svg(const BinCounts& histogram, const std::string& axis, const std::string& unit,
                          int steps) {
    constexpr double width = 420, height = 190, left = 8, right = 8, top = 18, bottom = 38;
    constexpr double plot_width = width - left - right, plot_height = height - top - bottom;
    std::int64_t total = 0;
    for (const std::int64_t count : histogram.counts) total += count;
    const double tallest = static_cast<double>(std::max<std::int64_t>(1, std::ranges::max(histogram.counts)));
    const double bar = plot_width / static_cast<double>(histogram.counts.size());
    const double bin = (histogram.high - histogram.low) / static_cast<double>(histogram.counts.size());

    std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Histogram: {}\">\n",
                                  width, height, escaped(axis));
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
        if (histogram.counts[i] == 0) continue;
        // A bin that is not empty stays visible, however rare.
        const double h = std::max(1.5, plot_height * static_cast<double>(histogram.counts[i]) / tallest);
        const double low = histogram.low + static_cast<double>(i) * bin;
        svg += fmt::format(
            "<rect class=\"bar\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"><title>{:.4g} "
            "to "
            "{:.4g}{}: {}</title></rect>\n",
            left + static_cast<double>(i) * bar + 0.5, top + plot_height - h, bar - 1, h, low, low + bin,
            escaped(unit), html::grouped(histogram.counts[i]));
    }
    svg += fmt::format("<line class=\"axis\" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"/>\n", left,
                       top + plot_height, width - right, top + plot_height);
    for (int i = 0; i <= steps; ++i) {
        const double part = static_cast<double>(i) / steps;
        svg += fmt::format("<text class=\"tick\" x=\"{:.2f}\" y=\"{}\" text-anchor=\"{}\">{:.3g}{}</text>\n",
                           left + part * plot_width, top + plot_height + 14,
                           i == 0       ? "start"
                           : i == steps ? "end"
                                        : "middle",
                           histogram.low + part * (histogram.high - histogram.low), escaped(unit));
    }
    svg += fmt::format("<text class=\"name\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", width / 2,
                       height - 5, escaped(axis));
    svg += fmt::format("<text class=\"tick\" x=\"{}\" y=\"11\" text-anchor=\"end\">{} in all</text>\n",
                       width - right, html::grouped(total));
    return svg + "</svg>";
}

std::string stages_svg(const std::vector<StageRecord>& stages) {
    constexpr double width = 860, row = 26, name_width = 210, figures_width = 190;
    constexpr double longest_bar = width - name_width - figures_width;
    double longest = 1e-9;
    for (const StageRecord& stage : stages) longest = std::max(longest, stage.seconds);
    const double height = row * static_cast<double>(stages.size()) + 6;
    std::string svg = fmt::format(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Time and peak memory of each stage\">\n", width,
        height);
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const StageRecord& stage = stages[i];
        const bool ran = stage.status == "run";
        const double y = row * static_cast<double>(i) + 4;
        const double length = std::max(1.5, longest_bar * stage.seconds / longest);
        std::string figures = fmt::format("{:.2f} s · {} MB", stage.seconds,
                                          html::grouped((stage.peak_memory_bytes + 500'000) / 1'000'000));
        if (!ran) figures += " · " + stage.status;
        svg += fmt::format("<text class=\"stage\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                           name_width - 10, y + 14, escaped(stage.stage));
        svg += fmt::format(
            "<rect class=\"{}\" x=\"{}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"18\" rx=\"2\"/>\n",
            ran ? "bar" : "bar idle", name_width, y, length);
        svg += fmt::format("<text class=\"figures\" x=\"{:.2f}\" y=\"{:.1f}\">{}</text>\n",
                           name_width + length + 8, y + 14, escaped(figures));
    }
    return svg + "</svg>";
}

}  // namespace palpate::report
