// SPDX-License-Identifier: GPL-3.0-or-later
// Which series of a folder is meant.
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/dicom/dicom_series.hpp"

namespace palpate::imaging {
namespace {

std::string listed(const std::vector<DicomSeries>& all, bool descriptions) {
    std::string list;
    for (const auto& [summary, colours, slices] : all)
        list += fmt::format(
            "\n  {}: {} {} slices of {} x {}, {:.3g} x {:.3g} x {:.3g} mm{}{}", summary.number,
            summary.modality, summary.size[2], summary.size[1], summary.size[0], summary.spacing[0],
            summary.spacing[1], summary.spacing[2], summary.localizer ? ", localizer" : "",
            !descriptions || summary.description.empty() ? "" : fmt::format(", \"{}\"", summary.description));
    return list;
}

}  // namespace

void number_series(std::vector<DicomSeries>& all) {
    const auto number = [](const DicomSeries& series) {
        int value = 0;
        const std::string& digits = series.summary.number;
        std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return value;
    };
    std::ranges::stable_sort(all, {}, number);
    std::set<int> distinct;
    for (const DicomSeries& series : all) distinct.insert(number(series));
    const bool keep = distinct.size() == all.size() && (all.size() == 1 || !distinct.contains(0)) &&
                      !all.front().summary.number.empty();
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i].summary.number = std::to_string(keep ? number(all[i]) : static_cast<int>(i + 1));
}

const DicomSeries& choose_series(const std::vector<DicomSeries>& all, const ReadOptions& options,
                                 const std::filesystem::path& path, const NoteSink& note) {
    const std::string& wanted = options.series;
    const auto refuse = [&](const std::string& found) {
        return InvalidInput(
            {path.string(), found + listed(all, options.show_descriptions), "",
             "\nchoose one by number, UID or description: with 'palpate import ... --series " +
                 all.front().summary.number + "'"});
    };
    if (!wanted.empty()) {
        std::vector<const DicomSeries*> found;
        for (const auto matches :
             {&SeriesSummary::number, &SeriesSummary::uid, &SeriesSummary::description}) {
            for (const DicomSeries& series : all)
                if (series.summary.*matches == wanted) found.push_back(&series);
            if (found.size() > 1)  // a series' own localizers share its UID and description
                std::erase_if(found, [](const DicomSeries* series) { return series->summary.localizer; });
            if (found.size() == 1) return *found.front();
            if (!found.empty()) break;
        }
        throw refuse(
            fmt::format("{} series are '{}':", found.empty() ? "no" : std::to_string(found.size()), wanted));
    }
    const auto largest = std::ranges::max_element(all, {}, [](const DicomSeries& series) {
        return series.summary.localizer ? std::size_t{0} : series.slices.size();
    });
    for (const DicomSeries& other : all)
        if (&other != &*largest && !other.summary.localizer &&
            5 * other.slices.size() > largest->slices.size())
            throw refuse(fmt::format("holds {} series:", all.size()));
    if (note && all.size() > 1)
        note(fmt::format(
            "the folder holds {} series; reading number {}, {} slices, as the others are localizers or "
            "have a fifth of them at most",
            all.size(), largest->summary.number, largest->slices.size()));
    return *largest;
}

}  // namespace palpate::imaging
