// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkSmartPointer.h>

#include "formats/model/errors.hpp"
#include "runtime/visual/playback/film.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace visual;

vtkSmartPointer<vtkImageData> grey(int width, int height, int shade) {
    auto pixels = vtkSmartPointer<vtkImageData>::New();
    pixels->SetDimensions(width, height, 1);
    pixels->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    auto* bytes = static_cast<unsigned char*>(pixels->GetScalarPointer());
    std::fill_n(bytes, 3 * width * height, static_cast<unsigned char>(shade));
    return pixels;
}

TEST(Film, of_pictures_numbers_them_in_their_order) {
    const sample::Scratch scratch;
    const auto film = picture_film(scratch / "");
    for (int shade : {10, 20, 30}) film->add(grey(8, 6, shade));
    film->end();
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName((scratch / "00002.png").c_str());
    reader->Update();
    EXPECT_EQ(reader->GetOutput()->GetDimensions()[0], 8);
    EXPECT_EQ(reader->GetOutput()->GetScalarComponentAsDouble(0, 0, 0, 0), 30);
    EXPECT_FALSE(std::filesystem::exists(scratch / "00003.png"));
}

TEST(Film, as_a_video_is_one_ogg_stream_of_any_size_of_picture) {
    const sample::Scratch scratch;
    const auto film = video_film(scratch / "film.ogv", 25);
    for (int shade = 0; shade < 50; ++shade)
        film->add(grey(331, 201, 5 * shade));  // sides no codec is fond of
    film->end();
    std::ifstream file(scratch / "film.ogv", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(bytes.substr(0, 4), "OggS");
    EXPECT_NE(bytes.find("\x80theora"), std::string::npos);
}

TEST(Film, refuses_pictures_of_another_size_than_its_first) {
    const sample::Scratch scratch;
    const auto film = video_film(scratch / "film.ogv", 25);
    film->add(grey(320, 240, 0));
    EXPECT_THROW(film->add(grey(320, 200, 0)), InvalidInput);
}

TEST(Film, that_cannot_be_written_says_so) {
    EXPECT_THROW(video_film("/nowhere/film.ogv", 25)->add(grey(320, 240, 0)), SystemFailure);
    EXPECT_THROW(picture_film("/nowhere")->add(grey(320, 240, 0)), SystemFailure);
}

}  // namespace
}  // namespace palpate
