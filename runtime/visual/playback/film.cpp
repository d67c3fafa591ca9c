// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/playback/film.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOggTheoraWriter.h>

#include "formats/model/errors.hpp"
#include "runtime/visual/pictures.hpp"

namespace palpate::visual {
namespace {

class VideoFilm final : public Film {
  public:
    VideoFilm(const std::filesystem::path& path, int rate) : path_(path) {
        writer_->SetFileName(path.c_str());
        writer_->SetRate(rate);
        writer_->SetQuality(2);
        writer_->SubsamplingOn();  // colour at half the size, which every player takes
    }

    void add(vtkImageData* pixels) override {
        std::array<int, 3> size{};
        pixels->GetDimensions(size.data());
        if (size_ != size && begun_)
            throw InvalidInput({"the window", fmt::format("is {} x {} pixels now", size[0], size[1]),
                                fmt::format("{} x {}, as at the film's beginning", size_[0], size_[1]),
                                "leave its size as it is until the film ends"});
        size_ = size;
        writer_->SetInputData(pixels);
        if (!begun_) {
            writer_->Start();
            refuse_failure();
            begun_ = true;
        }
        writer_->Write();
        refuse_failure();
    }

    void end() override {
        writer_->End();
        refuse_failure();
    }

  private:
    void refuse_failure() {
        if (writer_->GetError() != 0)
            throw SystemFailure(
                {path_.string(), "the video could not be written", "", "check free space and permissions"});
    }

    std::filesystem::path path_;
    vtkNew<vtkOggTheoraWriter> writer_;
    std::array<int, 3> size_{};
    bool begun_ = false;
};

class PictureFilm final : public Film {
  public:
    explicit PictureFilm(std::filesystem::path folder) : folder_(std::move(folder)) {}

    void add(vtkImageData* pixels) override {
        write_picture(folder_ / fmt::format("{:05}.png", count_++), pixels);
    }
    void end() override {}

  private:
    std::filesystem::path folder_;
    int count_ = 0;
};

}  // namespace

std::unique_ptr<Film> video_film(const std::filesystem::path& path, int rate) {
    return std::make_unique<VideoFilm>(path, rate);
}

std::unique_ptr<Film> picture_film(const std::filesystem::path& folder) {
    return std::make_unique<PictureFilm>(folder);
}

}  // namespace palpate::visual
