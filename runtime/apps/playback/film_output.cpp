// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/playback/film_output.hpp"

#include "formats/model/errors.hpp"

namespace palpate::apps {

FilmOutput::FilmOutput(const std::filesystem::path& video, const std::filesystem::path& pictures, int rate,
                       const cli::Session& session) {
    if (!video.empty())
        films_.push_back(visual::video_film(video_.emplace(video, session.force).path(), rate));
    if (pictures.empty()) return;
    if (std::filesystem::exists(pictures))
        throw InvalidInput({pictures.string(), "exists already", "a folder that is not there yet",
                            "choose another name; --force empties no folder"});
    pictures_.emplace(pictures, false);
    films_.push_back(visual::picture_film(pictures_->path()));
}

void FilmOutput::take(visual::TrainWindow& window) {
    for (const auto& film : films_) window.add_to(*film);
}

void FilmOutput::commit() {
    for (const auto& film : films_) film->end();
    if (video_) video_->commit();
    if (pictures_) pictures_->commit();
}

}  // namespace palpate::apps
