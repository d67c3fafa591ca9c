// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "formats/asset/body_io.hpp"
#include "formats/model/errors.hpp"
#include "formats/records/certificate.hpp"
#include "formats/records/device_limits.hpp"
#include "formats/records/felt_region.hpp"
#include "formats/records/haptic_settings.hpp"
#include "formats/records/material.hpp"
#include "formats/records/quality_contract.hpp"
#include "formats/records/status_counts.hpp"
#include "formats/records/tick_result.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace asset;
using sample::Scratch;

// A record whose default has moved since a file without the field was written.
struct Spring {
    double stiffness = 3;
    double rest_length = 7;
};
constexpr std::tuple spring_fields{Field("stiffness", &Spring::stiffness, "N/mm", "", positive),
                                   Field("rest_length", &Spring::rest_length, "mm", "").since(2, 5.0)};

TEST(Field, stays_as_it_was_while_more_is_said_of_it) {
    const auto field = Field("stiffness", &Spring::stiffness, "N/mm", "of a spring", positive)
                           .since(3, 5.0)
                           .none_is(-1.0)
                           .written_in("kPa", 1e3)
                           .stored_as<float>();
    static_assert(std::is_same_v<decltype(field)::Storage, float>);
    static_assert(std::is_same_v<decltype(field)::Value, double>);
    EXPECT_STREQ(field.name, "stiffness");
    EXPECT_EQ(field.member, &Spring::stiffness);
    EXPECT_STREQ(field.unit, "N/mm");
    EXPECT_STREQ(field.meaning, "of a spring");
    EXPECT_EQ(to_string(field.range), "a positive number");
    EXPECT_EQ(field.schema, 3);
    EXPECT_EQ(field.absent, 5.0);
    EXPECT_EQ(field.not_measured, -1.0);
    EXPECT_STREQ(field.written_unit, "kPa");
    EXPECT_EQ(field.written_factor, 1e3);
    EXPECT_EQ(key_of(field), "stiffness_kpa");
}

TEST(Records, ranges_are_told_as_people_say_them) {
    EXPECT_EQ(to_string(any_number), "a finite number");
    EXPECT_EQ(to_string(not_negative), "0 or more");
    EXPECT_EQ(to_string(Range{.most = 4}), "at most 4");
    EXPECT_EQ(to_string(Range{.least = 0, .most = 180}), "0 to 180");
    EXPECT_EQ(to_string(Range{.least = -1, .most = 0.5, .ends_belong = false}), "between -1 and 0.5");
    EXPECT_EQ(to_string(Range{.least = 2, .ends_belong = false}), "more than 2");
}

TEST(Records, an_absent_field_means_what_its_table_says_and_not_the_present_default) {
    const Scratch scratch;
    {
        Hdf5Writer writer(scratch / "old.h5");
        writer.group("/spring");
        writer.attribute("/spring", "stiffness", 2.0);
        writer.finish("/spring");
    }
    Spring read;
    read_fields(Hdf5File(scratch / "old.h5"), "/spring", spring_fields, read);
    EXPECT_EQ(read.stiffness, 2);
    EXPECT_EQ(read.rest_length, 5);
}

TEST(Records, a_field_that_files_always_had_may_not_be_absent) {
    const Scratch scratch;
    {
        Hdf5Writer writer(scratch / "damaged.h5");
        writer.group("/spring");
        writer.attribute("/spring", "rest_length", 2.0);
        writer.finish("/spring");
    }
    Spring read;
    EXPECT_THROW(read_fields(Hdf5File(scratch / "damaged.h5"), "/spring", spring_fields, read), InvalidInput);
}

TEST(Records, the_first_field_out_of_its_range_is_named_with_value_unit_and_range) {
    EXPECT_FALSE(first_error(spring_fields, Spring{}));
    for (const double wrong : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        const auto error = first_error(spring_fields, Spring{.stiffness = wrong});
        ASSERT_TRUE(error) << wrong;
        EXPECT_EQ(error->name, "stiffness");
        EXPECT_THAT(error->found, testing::EndsWith(" N/mm"));
        EXPECT_EQ(error->expected, "a positive number");
    }
    EXPECT_EQ(first_error(material_fields, Material{.youngs_modulus = 1, .poissons_ratio = 0.5})->expected,
              "between -1 and 0.5");
    const auto sliding = haptics_error({.friction_at_rest = 0.1, .friction_sliding = 0.2});
    ASSERT_TRUE(sliding);
    EXPECT_EQ(sliding->name, "friction_sliding");
    EXPECT_EQ(sliding->found, "is 0.200000");
    EXPECT_EQ(sliding->expected, "0 to friction_at_rest");
}

TEST(Records, a_relaxation_that_makes_no_sense_is_named) {
    using Terms = std::vector<RelaxationTerm>;
    EXPECT_FALSE(relaxation_error(Terms{}));
    EXPECT_FALSE(relaxation_error(Terms{{0.5, 0.1}, {0.4999, 10}}));
    const auto name = [](const Terms& terms) {
        const auto error = relaxation_error(terms);
        return error ? error->name + " " + error->found : "";
    };
    EXPECT_EQ(name({{0, 1}}), "share is 0.000000");
    EXPECT_EQ(name({{1, 1}}), "share is 1.000000");
    EXPECT_EQ(name({{std::nan(""), 1}}), "share is nan");
    EXPECT_EQ(name({{0.5, 0}}), "time is 0.000000 s");
    EXPECT_EQ(name({{0.5, 1e-9}}), "time is 0.000000 s");
    EXPECT_EQ(name({{0.5, 1e300}}).substr(0, 9), "time is 1");
    EXPECT_EQ(name({{0.5, 1}, {0.4999999, 2}}), "share is 1.000000 in all terms together");
    EXPECT_EQ(name({{0.5, 1}, {0.25, 1}}), "time is 1.000000 s after 1.000000");
    EXPECT_EQ(name({{0.5, 1}, {0.5, 2}}), "share is 1.000000 in all terms together");
    EXPECT_EQ(name({{0.1, 1}, {0.1, 2}, {0.1, 3}, {0.1, 4}, {0.1, 5}}), "relaxation has 5 terms");
    EXPECT_EQ(relaxation_text(Terms{{0.3, 1}, {0.25, 10}}), "30 % in 1 s, 25 % in 10 s");
    EXPECT_EQ(relaxation_text(Terms{}), "none");
}

TEST(Records, keys_options_and_titles_follow_from_name_and_unit) {
    EXPECT_EQ(key_of("coupling_stiffness", "N/mm"), "coupling_stiffness_n_per_mm");
    EXPECT_EQ(key_of(std::get<0>(material_fields)), "youngs_modulus_kpa");
    EXPECT_EQ(key_of("min_dihedral_deg", "degrees"), "min_dihedral_deg");
    EXPECT_EQ(key_of(quality_fields, &QualityContract::max_distance), "max_distance_voxel_diagonals");
    EXPECT_EQ(option_name("max_p95_distance"), "--max-p95-distance");
    EXPECT_EQ(title_of("tool_radius"), "Tool radius");
}

template <typename Record, typename Table>
void expect_whole(const Table& table) {
    std::set<std::string> names;
    const Record record{};
    std::set<const void*> members;
    for_each_field(table, [&](const auto& field) {
        EXPECT_TRUE(names.insert(field.name).second) << field.name;
        EXPECT_TRUE(members.insert(&(record.*field.member)).second) << field.name;
        EXPECT_STRNE(field.meaning, "") << field.name;
    });
}

TEST(Records, no_table_names_a_field_twice) {
    expect_whole<HapticSettings>(haptic_fields);
    expect_whole<QualityContract>(quality_fields);
    expect_whole<Material>(material_fields);
    expect_whole<RelaxationTerm>(relaxation_fields);
    expect_whole<Certificate>(certificate_fields);
    expect_whole<DeviceLimits>(device_limit_fields);
    expect_whole<Tick>(tick_fields);
    expect_whole<Contact>(contact_fields);
    EXPECT_FALSE(haptics_error(HapticSettings{}));
    EXPECT_FALSE(first_error(quality_fields, QualityContract{}));
}

// A member that no table names would be lost on the way through a file.
TEST(Records, tables_of_plain_doubles_name_every_member) {
    EXPECT_EQ(std::tuple_size_v<decltype(haptic_fields)> * sizeof(double), sizeof(HapticSettings));
    EXPECT_EQ(std::tuple_size_v<decltype(quality_fields)> * sizeof(double), sizeof(QualityContract));
    EXPECT_EQ(std::tuple_size_v<decltype(material_fields)> * sizeof(double), sizeof(Material));
}

TEST(Contact, pushes_the_tool_back_along_its_normal_and_by_friction_unless_a_neighbour_presses) {
    Contact contact;
    contact.normal = {0, 0, 1};
    contact.force = 2;
    contact.friction = {0.5F, 0, 0};
    EXPECT_EQ(normal_of(contact), Eigen::Vector3d(0, 0, 1));
    EXPECT_EQ(reaction_of(contact), Eigen::Vector3d(0.5, 0, 2));
    EXPECT_FALSE(is_of_neighbour(contact));
    EXPECT_EQ(force_on_tool(contact), Eigen::Vector3d(0.5, 0, 2));
    contact.other_body = 0;
    EXPECT_TRUE(is_of_neighbour(contact));
    EXPECT_EQ(reaction_of(contact), Eigen::Vector3d(0.5, 0, 2));
    EXPECT_EQ(force_on_tool(contact), Eigen::Vector3d(0, 0, 0));
}

TEST(TickResult, is_copied_with_the_contacts_that_count_and_no_others) {
    TickResult from{}, to{};
    from.tick = 7;
    from.contact_count = 2;
    for (std::size_t i = 0; i < 3; ++i) {
        from.contacts[i].body = static_cast<std::int32_t>(10 + i);
        to.contacts[i].body = static_cast<std::int32_t>(20 + i);
    }
    EXPECT_EQ(from.active_contacts().size(), 2U);
    copy_active(from, to);
    EXPECT_EQ(to.tick, 7);
    EXPECT_EQ(to.active_contacts()[0].body, 10);
    EXPECT_EQ(to.active_contacts()[1].body, 11);
    EXPECT_EQ(to.contacts[2].body, 22);
}

TickResult tick_at(double time, std::uint32_t status, std::uint32_t faults = no_fault) {
    TickResult result{};
    result.time = time;
    result.status = status;
    result.faults = faults;
    return result;
}

TEST(TickStatus, every_flag_has_one_text_and_a_name) {
    std::set<std::string> names;
    std::uint32_t flags = tick_ok;
    for (const StatusText& text : status_texts()) {
        EXPECT_EQ(flags + 1, text.status);  // in order, and none left out
        flags |= text.status;
        names.insert(text.name);
        EXPECT_NE(std::string(text.meaning), "");
    }
    EXPECT_EQ(names.size(), status_count);
    EXPECT_EQ(status_text(tick_ok), "ok");
    EXPECT_EQ(status_text(force_limited | contacts_cut), "force_limited+contacts_cut");
}

TEST(StatusCounts, count_each_flag_and_forget_it_to_the_eye_after_two_seconds) {
    StatusCounts counts;
    counts.add(tick_at(1, tick_ok));
    EXPECT_TRUE(counts.by_name().empty());
    counts.add(tick_at(2, contacts_cut | rate_limited));
    counts.add(tick_at(3, contacts_cut));
    EXPECT_EQ(counts.by_name(),
              (std::map<std::string, std::int64_t>{{"contacts_cut", 2}, {"rate_limited", 1}}));
    EXPECT_EQ(counts.recent(3.5), contacts_cut | rate_limited);
    EXPECT_EQ(counts.recent(4.5), contacts_cut);
    EXPECT_EQ(counts.recent(5.5), tick_ok);
}

TEST(StatusCounts, the_closing_line_names_what_a_user_must_know_and_nothing_else) {
    StatusCounts counts;
    counts.add(tick_at(0, force_limited | rate_limited | coming_back));
    counts.add(tick_at(1, tick_ok, servo_stopping));
    EXPECT_EQ(counts.closing_line(), "");
    counts.add(tick_at(2, starts_inside | rate_limited));
    counts.add(tick_at(3, starts_inside | contact_unsolved));
    counts.add(tick_at(4, tick_ok, device_lost | servo_stopping));
    EXPECT_EQ(counts.closing_line(),
              "not all ticks were as they should be: "
              "1 contact_unsolved (contacts contradict each other, as in a wedge: no body gives way); "
              "2 starts_inside (a tool is in a body, which is not felt until the tool has been clear of it); "
              "1 with a fault (the force was taken away: device_lost)");
}

TEST(FeltRegion, is_felt_where_a_hand_tells_its_contrast_its_surroundings_bear_it_and_a_device_renders_it) {
    const auto verdict = [](double without, double with, double variation, double depth) {
        return verdict_of({.region = 2,
                           .vertex = 0,
                           .depth = 1,
                           .stiffness = with,
                           .stiffness_without = without,
                           .variation = variation},
                          depth);
    };
    EXPECT_EQ(verdict(0.1, 0.13, 0.2, 3), FeltVerdict::felt);
    EXPECT_EQ(verdict(0.1, 0.07, 0.2, 3), FeltVerdict::felt);  // softer
    EXPECT_EQ(verdict(0.1, 0.114, 0, 10), FeltVerdict::too_faint);
    EXPECT_EQ(verdict(0.1, 0.13, 0.31, 3), FeltVerdict::too_varied);
    EXPECT_EQ(verdict(0.1, 0.13, 0.2, 1.9), FeltVerdict::too_weak);  // 0.057 N
    EXPECT_STREQ(verdict_word(FeltVerdict::too_varied), "too varied");
}

}  // namespace
}  // namespace palpate
