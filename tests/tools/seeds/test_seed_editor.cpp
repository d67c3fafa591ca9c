// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "sample_data/phantoms.hpp"
#include "tools/seeds/seed_editor.hpp"

namespace palpate {
namespace {

using namespace seeds;

const Eigen::Vector3d liver_index(28, 30, 32);

class SeedEditorTest : public testing::Test {
  protected:
    const Volume volume = abdomen_phantom().volume;
    std::vector<imaging::Seed> written;
    bool disk_full = false;
    SeedEditor editor{volume, start_state(volume.grid, {"liver"}, {}), grey_scale(volume),
                      [this](std::span<const imaging::Seed> seeds) {
                          if (disk_full) throw SystemFailure({"a.mrk.json", "disk full", "", ""});
                          written.assign(seeds.begin(), seeds.end());
                          return std::string("a.mrk.json");
                      },
                      preview_growing(volume)};
};

TEST_F(SeedEditorTest, closes_at_once_without_unsaved_seeds) {
    editor.key("q");
    EXPECT_TRUE(editor.closed());
}

TEST_F(SeedEditorTest, with_unsaved_seeds_closes_when_asked_twice_in_a_row) {
    editor.place(liver_index);
    editor.quit();
    EXPECT_FALSE(editor.closed());
    editor.scroll(slice_views(volume.grid)[0], 1);  // a change of mind
    editor.quit();
    EXPECT_FALSE(editor.closed());
    editor.quit();
    EXPECT_TRUE(editor.closed());
}

TEST_F(SeedEditorTest, saves_all_seeds_and_may_then_close) {
    editor.key("s");
    EXPECT_TRUE(written.empty()) << "a file without a point cannot be read";
    editor.place(liver_index);
    editor.key("0");
    editor.place({50, 30, 32});
    editor.key("s");
    ASSERT_EQ(written.size(), 2U);
    EXPECT_EQ(written[1].label, "background");
    editor.key("escape");
    EXPECT_TRUE(editor.closed());
}

TEST_F(SeedEditorTest, tells_why_saving_failed_and_keeps_the_seeds_unsaved) {
    editor.place(liver_index);
    disk_full = true;
    editor.key("s");
    EXPECT_NE(editor.message().find("disk full"), std::string::npos);
    editor.quit();
    EXPECT_FALSE(editor.closed());
}

TEST_F(SeedEditorTest, every_change_of_seeds_grows_anew) {
    editor.place(liver_index);
    editor.finish();
    ASSERT_TRUE(editor.growth());
    EXPECT_GT(editor.growth()->volume_ml.at(0), 30);
    EXPECT_EQ(editor.growths(), 1);
    editor.remove(liver_index, 5);
    editor.finish();
    EXPECT_TRUE(editor.growth()->map.labels.empty());
    editor.key("u");
    editor.finish();
    EXPECT_GT(editor.growth()->volume_ml.at(0), 30);
    EXPECT_EQ(editor.growths(), 2);
}

TEST_F(SeedEditorTest, grey_keys_go_round_the_presets_and_dragging_leaves_them) {
    const GreyScale greys = grey_scale(volume);
    for (std::size_t n = 1; n <= greys.presets.size(); ++n) {
        editor.key("plus");
        EXPECT_EQ(editor.grey().name, greys.presets[n % greys.presets.size()].name);
    }
    editor.key("minus");
    EXPECT_EQ(editor.grey().name, greys.presets.back().name);
    const GreyPreset before = editor.grey();
    editor.drag_grey(100, 50);
    EXPECT_GT(editor.grey().width, before.width);
    EXPECT_LT(editor.grey().level, before.level) << "brighter";
}

}  // namespace
}  // namespace palpate
