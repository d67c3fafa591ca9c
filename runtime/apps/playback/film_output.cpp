// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/playback/film_output.hpp"

#include <system_error>

#include "formats/model/errors.hpp"

namespace palpate::apps {
namespace {

// Makes the folder in which pictures gather until they are all there.
std::filesystem::path make_beside(const std::filesystem::path& folder) {
    const std::filesystem::path parent = folder.has_parent_path() ? folder.parent_path() : ".";
    const std::filesystem::path staged = parent / (".part-" + folder.filename().string());
    std::error_code error;
    if (std::filesystem::exists(folder))
        throw InvalidInput({folder.string(), "exists already", "a folder that is not there yet",
                            "choose another name; --force empties no folder"});
    std::filesystem::remove_all(staged, error);  // of a run that was killed
    if (!std::filesystem::create_directory(staged, error))
        throw InvalidInput({folder.string(), "cannot be made: " + error.message(), "",
                            "name a folder in one that is there and may be written to"});
    return staged;
}

}  // namespace

FilmOutput::FilmOutput(const std::filesystem::path& video, const std::filesystem::path& pictures, int rate,
                       const cli::Session& session) {
    if (!video.empty())
        films_.push_back(visual::video_film(video_.emplace(video, session.force).path(), rate));
    if (pictures.empty()) return;
    // "series/" is the same folder as "series".
    folder_ = pictures.has_filename() ? pictures : pictures.parent_path();
    staged_folder_ = make_beside(folder_);
    films_.push_back(visual::picture_film(staged_folder_));
}

FilmOutput::~FilmOutput() {
    std::error_code ignored;
    if (!staged_folder_.empty()) std::filesystem::remove_all(staged_folder_, ignored);
}

void FilmOutput::take(visual::TrainWindow& window) {
    for (const auto& film : films_) window.add_to(*film);
}

void FilmOutput::commit() {
    for (const auto& film : films_) film->end();
    if (video_) video_->commit();
    if (!folder_.empty()) std::filesystem::rename(staged_folder_, folder_);
}

}  // namespace palpate::apps
