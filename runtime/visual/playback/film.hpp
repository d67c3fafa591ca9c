// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>

class vtkImageData;

namespace palpate::visual {

/// Where the pictures of a film go, one after the other, all of the first one's size.
class Film {
  public:
    virtual ~Film() = default;
    Film() = default;
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    /// Adds a picture of RGB bytes. Throws SystemFailure if it cannot be written, InvalidInput if it is of
    /// another size.
    virtual void add(vtkImageData* pixels) = 0;
    /// Writes what is still to be written. Throws as add(). Once, after the last picture.
    virtual void end() = 0;
};

/// An Ogg file with a Theora stream of `rate` (1 or more) pictures a second. Throws SystemFailure if it
/// cannot be opened.
std::unique_ptr<Film> video_film(const std::filesystem::path& path, int rate);

/// PNG files 00000.png, 00001.png, ... in a folder that is there.
std::unique_ptr<Film> picture_film(const std::filesystem::path& folder);

}  // namespace palpate::visual
