// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <future>
#include <gtest/gtest.h>
#include <set>
#include <unistd.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include "formats/model/errors.hpp"
#include "tests/formats/sample_case.hpp"
#include "tools/report/pictures/colour_scale.hpp"
#include "tools/report/report.hpp"
#include "tools/report/sections.hpp"

namespace palpate {
namespace {

using namespace report;

Case hostile_case() {
    Case patient_case = sample::sample_case(6);
    patient_case.name = "<script>alert('Doe & \"Co\"')</script>";
    patient_case.deformable_bodies.front().name = "wall</td><img>";
    patient_case.deformable_bodies.front().mesh.region_names.back().name = "tumour <b>";
    patient_case.provenance =
        R"({"tool":{"name":"<i>palpate</i>"},"inputs":["a & b"],"build":{"steps":[7,{"request":3},{"request":{"posture":1}},)"
        R"({"command":"condense","request":{"name":"wall<","scanned":"supine","posture":"<b>prone"}}],)"
        R"("cautions":["wall is <u>made up", 7]},"notes":["HU & more"],"meshes":{"cube":{"at_image_edge":["cube<"],"checks":[)"
        R"({"name":"max_mean_distance_mm","measure":"the mean <i>surface</i> distance","region":"cube","value":0.3,)"
        R"("bound":"at most","limit":0.25,"unit":"mm","met":false},)"
        R"({"what":"the volume error of 'cube'","found":"0.5 %","limit":"at most 1 %","kept":true}]}}})";
    return patient_case;
}

LabelMap label_map() {
    LabelMap map{.grid = {.size = {30, 30, 30}, .spacing = {1, 1, 1}, .origin = {-5, -5, -5}},
                 .labels = std::vector<std::uint16_t>(27000),
                 .names = {{.value = 1, .name = "tissue & more", .colour = {0.2F, 0.9F, 0.3F}}}};
    for (std::int32_t k = 5; k < 25; ++k)
        for (std::int32_t j = 5; j < 25; ++j)
            for (std::int32_t i = 5; i < 25; ++i) map.labels[map.grid.offset(i, j, k)] = 1;
    return map;
}

Volume volume_like(const LabelMap& map) {
    Volume volume{.grid = map.grid, .values = {}};
    for (const std::uint16_t label : map.labels) volume.values.push_back(label ? 60.0F : -1000.0F);
    return volume;
}

std::string full_page() {
    static const std::string page = [] {
        const Case patient_case = hostile_case();
        const LabelMap labels = label_map();
        const Volume volume = volume_like(labels);
        ReportInputs inputs{.patient_case = patient_case, .volume = &volume, .labels = &labels};
        inputs.touch = nlohmann::json::parse(R"({"ticks": 10000, "overruns": 3, "force_peak_n": 1.25,
            "penetration": {"device_mm": 3.5}, "tick_us": {"p50": 4.5, "p99": 11.25, "p99_9": 20, "max": 31}})");
        inputs.force_curve_svg = "<svg xmlns=\"http://www.w3.org/2000/svg\"><script>1</script></svg>";
        inputs.stages = {{"mesh <wall>", 3.25, 123'000'000, "run"}, {"pack", 0.5, 7'000'000, "up to date"}};
        const DeformableBody& body = patient_case.deformable_bodies.front();
        std::promise<std::vector<SurfaceComparison>> compared;
        compared.set_value(
            {{body.name, "label <a>", std::vector<double>(body.boundary.surface.triangles.size(), 0.25),
              0.125, 0.25, 0.375, body.boundary.surface.vertices.front()}});
        inputs.comparisons = compared.get_future().share();
        return html_report(inputs);
    }();
    return page;
}

std::string bare_page() {
    const Case patient_case = sample::sample_case(2);
    return html_report({.patient_case = patient_case});
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::vector<std::string> attributes(const std::string& page, const std::string& name) {
    std::vector<std::string> values;
    const std::string key = " " + name + "=\"";
    for (std::size_t at = 0; (at = page.find(key, at)) != std::string::npos;) {
        at += key.size();
        values.push_back(page.substr(at, page.find('"', at) - at));
    }
    return values;
}

// Every opened element is closed in order; returns the first fault.
std::string nesting_fault(const std::string& page) {
    const std::set<std::string> empty{"meta", "img", "br"};
    std::vector<std::string> open;
    for (std::size_t at = 0; (at = page.find('<', at)) != std::string::npos;) {
        const std::size_t end = page.find('>', at);
        if (end == std::string::npos) return "a tag without an end";
        const std::string tag = page.substr(at + 1, end - at - 1);
        at = end + 1;
        std::string name = tag.substr(0, tag.find_first_of(" \n"));
        if (name.starts_with("!") || tag.ends_with("/") || empty.contains(name)) continue;
        if (!name.starts_with("/")) {
            open.push_back(name);
            continue;
        }
        if (open.empty() || open.back() != name.substr(1))
            return name + " closes " + (open.empty() ? "nothing" : open.back());
        open.pop_back();
    }
    return open.empty() ? "" : open.back() + " is never closed";
}

std::string decoded(const std::string& base64) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned group = 0;
    int bits = 0;
    for (const char c : base64) {
        if (c == '=') break;
        group = group << 6 | static_cast<unsigned>(digits.find(c));
        if ((bits += 6) < 8) continue;
        bits -= 8;
        bytes += static_cast<char>(group >> bits & 0xFF);
    }
    return bytes;
}

std::size_t colours_of_png(const std::string& bytes) {
    vtkNew<vtkPNGReader> reader;
    reader->SetMemoryBuffer(bytes.data());
    reader->SetMemoryBufferLength(static_cast<vtkIdType>(bytes.size()));
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    const int* size = image->GetDimensions();
    std::set<std::array<std::uint8_t, 3>> colours;
    for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x) {
            const auto* p = static_cast<const std::uint8_t*>(image->GetScalarPointer(x, y, 0));
            colours.insert({p[0], p[1], p[2]});
        }
    return colours.size();
}

class ReportTest : public testing::Test {
  protected:
    void SetUp() override {
        if (std::getenv("DISPLAY") == nullptr && access("/usr/bin/Xvfb", X_OK) != 0)
            GTEST_SKIP() << "xvfb is not installed";
    }
};

TEST_F(ReportTest, elements_are_nested_and_closed) {
    EXPECT_EQ(nesting_fault(full_page()), "");
    EXPECT_EQ(nesting_fault(bare_page()), "");
}

TEST_F(ReportTest, page_needs_nothing_from_outside) {
    const std::string page = full_page();
    for (const std::string& source : attributes(page, "src"))
        EXPECT_TRUE(source.starts_with("data:")) << source;
    for (const std::string& target : attributes(page, "href"))
        EXPECT_TRUE(target.starts_with("data:") || target.starts_with("#")) << target;
    for (const char* outside : {"http:", "https:", "<script", "<link", "url(", "@import"})
        EXPECT_FALSE(contains(page, outside)) << outside;
}

TEST_F(ReportTest, all_sections_are_there) {
    const std::string page = full_page();
    for (const Section& section : report_sections) {
        const std::string id = section.anchor;
        EXPECT_TRUE(contains(page, "<section id=\"" + id + "\">")) << id;
        EXPECT_TRUE(contains(page, "<a href=\"#" + id + "\">" + section.title)) << id;
    }
    EXPECT_FALSE(contains(page, "class=\"missing\""));
    EXPECT_TRUE(contains(page, "✓ Verified"));
    for (const char* figure : {"10\u202f000", "1.25 N", "3.5 mm", "11.25"})
        EXPECT_TRUE(contains(page, figure)) << figure;
    EXPECT_TRUE(contains(page, "3.25 s"));
    EXPECT_TRUE(contains(page, "the mean &lt;i&gt;surface&lt;/i&gt; distance of &#39;cube&#39;"));
    EXPECT_TRUE(contains(page, "0.300 mm"));
    EXPECT_TRUE(contains(page, "at most 0.25 mm"));
    EXPECT_TRUE(contains(page, "at most 1 %"));  // as the first assets say it
    EXPECT_TRUE(contains(page, "<strong>missed</strong>"));
}

TEST_F(ReportTest, names_are_escaped) {
    const std::string page = full_page();
    EXPECT_TRUE(contains(page, "&lt;script&gt;alert(&#39;Doe &amp; &quot;Co&quot;&#39;)&lt;/script&gt;"));
    EXPECT_TRUE(contains(page, "wall&lt;/td&gt;&lt;img&gt;"));
    EXPECT_TRUE(contains(page, "tumour &lt;b&gt;"));
    EXPECT_TRUE(contains(page, "tissue &amp; more"));
    EXPECT_TRUE(contains(page, "mesh &lt;wall&gt;"));
    EXPECT_TRUE(contains(page, "&lt;i&gt;palpate&lt;/i&gt;"));
    EXPECT_FALSE(contains(page, "<i>"));
}

TEST_F(ReportTest, pictures_show_something) {
    std::size_t pictures = 0, shaded = 0;
    const std::string page = full_page();
    const std::string prefix = "data:image/png;base64,";
    for (const char* attribute : {"src", "href"})
        for (const std::string& value : attributes(page, attribute)) {
            if (!value.starts_with(prefix)) continue;
            ++pictures;
            const std::size_t colours = colours_of_png(decoded(value.substr(prefix.size())));
            EXPECT_GT(colours, 4U);
            shaded += colours > 100;
        }
    // Slices through the case and its one label; all bodies, one deformable body, its worst elements, its
    // distances, its stiffness.
    EXPECT_EQ(pictures, 3U + 3U + 2U + 2U + 2U + 2U + 2U);
    EXPECT_EQ(shaded, 8U);  // those in three dimensions, but for a cube in one flat colour
}

TEST_F(ReportTest, worst_elements_are_marked_with_their_angles) {
    const std::string page = full_page();
    for (const char* number : {">1</text>", ">5</text>"}) EXPECT_TRUE(contains(page, number)) << number;
    std::size_t angles = 0;
    for (std::size_t at = 0; (at = page.find("class=\"angle", at)) != std::string::npos; ++at) ++angles;
    EXPECT_EQ(angles, 3U * 6U);
}

TEST_F(ReportTest, distances_carry_a_scale_in_mm_and_the_farthest_place) {
    const std::string page = full_page();
    for (const char* words : {"label &lt;a&gt;", "0.38 mm", "≥ 0.5 mm", "0.125", ">A</text>", ">R</text>"})
        EXPECT_TRUE(contains(page, words)) << words;
}

TEST_F(ReportTest, what_can_be_felt_carries_a_scale_in_newtons_per_mm_and_a_verdict_on_each_region) {
    const std::string page = full_page(), section = page.substr(page.find("<section id=\"felt\">"));
    EXPECT_TRUE(contains(section, "✓</span> felt"));
    EXPECT_TRUE(contains(section, "+50.0 %"));
    EXPECT_TRUE(contains(section, " N/mm</text>"));
    EXPECT_TRUE(contains(section, "a sphere of 1.5 mm radius, pressed 4 mm deep"));
    Case silent = sample::sample_case(2);
    silent.deformable_bodies.front().feel.reset();
    EXPECT_FALSE(contains(html_report({.patient_case = silent}), "<section id=\"felt\">"));
}

TEST_F(ReportTest, a_shape_that_is_not_the_scans_says_so_whatever_the_provenance_holds) {
    EXPECT_TRUE(contains(full_page(),
                         "wall&lt;</b> was scanned supine and has the shape that gravity gives it "
                         "&lt;b&gt;prone"));
    EXPECT_FALSE(contains(bare_page(), "was scanned"));
}

TEST_F(ReportTest, beside_the_verdict_stands_what_it_does_not_say) {
    const std::string page = full_page();
    for (const char* words : {"<li>wall is &lt;u&gt;made up</li>", "<li>HU &amp; more</li>",
                              "‘cube&lt;’ reaches the image’s edge"})
        EXPECT_TRUE(contains(page, words)) << words;
    EXPECT_FALSE(contains(bare_page(), "What that does not say"));
}

TEST(ColourScale, ends_at_a_round_number_and_holds_there) {
    const std::vector<double> values{0.1, 0.2, 0.3, 0.4, 7.0};
    const ColourScale scale = scale_for(values);
    EXPECT_EQ(scale.top, 0.5);
    EXPECT_EQ(scale.colour_of(7), scale.colour_of(0.5));
    EXPECT_EQ(scale.colour_of(0), (std::array<std::uint8_t, 3>{255, 255, 204}));
}

TEST_F(ReportTest, a_missing_input_is_named_with_the_option_that_fills_it) {
    const std::string page = bare_page();
    for (const char* option : {"--volume", "--labels", "--touch", "--curve", "--stages"})
        EXPECT_TRUE(contains(page, option)) << option;
}

TEST_F(ReportTest, a_failed_certificate_is_not_called_verified) {
    Case patient_case = sample::sample_case(2);
    patient_case.deformable_bodies.front().certificate.residual = 1e-3;
    const std::string page = html_report({.patient_case = patient_case});
    EXPECT_TRUE(contains(page, "✗ Not verified"));
    EXPECT_TRUE(contains(page, "Residual is 0.001, must be ≤ 1e-06"));
    EXPECT_FALSE(contains(page, "✓ Verified"));
}

TEST_F(ReportTest, equal_inputs_give_equal_pages) {
    EXPECT_EQ(bare_page(), bare_page());
}

TEST(Stages, records_are_read_and_faults_named) {
    const auto stages = stages_from_json(
        nlohmann::json::parse(R"([{"stage":"mesh","seconds":3.5,"peak_memory_bytes":12,"status":"run"}])"),
        "stages.json");
    ASSERT_EQ(stages.size(), 1U);
    EXPECT_EQ(stages[0].stage, "mesh");
    EXPECT_EQ(stages[0].seconds, 3.5);
    EXPECT_EQ(
        stages_from_json(nlohmann::json::parse(R"([{"stage":"a","seconds":1,"peak_memory_bytes":2}])"), "")[0]
            .status,
        "run");
    for (const char* bad : {R"({"stage":"mesh"})", R"([{"stage":"mesh"}])", "[7]",
                            R"([{"stage":1,"seconds":1,"peak_memory_bytes":1,"status":"run"}])"})
        try {
            stages_from_json(nlohmann::json::parse(bad), "stages.json");
            ADD_FAILURE() << bad;
        } catch (const InvalidInput& error) {
            EXPECT_EQ(error.detail().culprit, "stages.json");
        }
}

}  // namespace
}  // namespace palpate
