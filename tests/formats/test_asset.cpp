// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <limits>
#include <map>
#include <span>
#include <variant>

#include "formats/asset/asset.hpp"
#include "formats/asset/body_io.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/parts.hpp"
#include "formats/asset/validate.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/formats/unchecked_body.hpp"

namespace palpate {
namespace {

using namespace asset;
using sample::cells;
using sample::hierarchical_cube;
using sample::refusal;
using sample::Scratch;
using ::testing::HasSubstr;

void expect_same(const ObbTree& a, const ObbTree& b) {
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    for (std::size_t i = 0; i < a.nodes.size(); ++i) {
        EXPECT_EQ(a.nodes[i].axes, b.nodes[i].axes);
        EXPECT_EQ(a.nodes[i].center, b.nodes[i].center);
        EXPECT_EQ(a.nodes[i].half_extents, b.nodes[i].half_extents);
        EXPECT_EQ(a.nodes[i].first, b.nodes[i].first);
        EXPECT_EQ(a.nodes[i].count, b.nodes[i].count);
    }
    EXPECT_EQ(a.triangle_order, b.triangle_order);
}

void expect_same(const std::vector<Label>& a, const std::vector<Label>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].value, b[i].value);
        EXPECT_EQ(a[i].name, b[i].name);
        EXPECT_EQ(a[i].colour, b[i].colour);
    }
}

void expect_same(const DenseCompliance& a, const DenseCompliance& b) {
    ASSERT_EQ(a.node_count, b.node_count);
    EXPECT_EQ(std::memcmp(a.entries.get(), b.entries.get(), a.dof_count() * a.dof_count() * sizeof(float)),
              0);
}

void expect_same(const HierarchicalCompliance& a, const HierarchicalCompliance& b) {
    EXPECT_EQ(a.node_count, b.node_count);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.accuracy, b.accuracy);
    EXPECT_EQ(a.order, b.order);
    EXPECT_EQ(a.positions, b.positions);
    ASSERT_EQ(a.blocks.size(), b.blocks.size());
    for (std::size_t i = 0; i < a.blocks.size(); ++i) {
        EXPECT_EQ(a.blocks[i].first_child, b.blocks[i].first_child);
        EXPECT_EQ(a.blocks[i].rank, b.blocks[i].rank);
        EXPECT_EQ(a.blocks[i].values, b.blocks[i].values);
        EXPECT_EQ(a.blocks[i].factors, b.blocks[i].factors);
    }
    EXPECT_TRUE(std::ranges::equal(std::span(a.values.get(), a.value_count),
                                   std::span(b.values.get(), b.value_count)));
    EXPECT_TRUE(std::ranges::equal(std::span(a.factors.get(), a.factor_count),
                                   std::span(b.factors.get(), b.factor_count)));
}

void expect_same(const Feel& a, const Feel& b) {
    EXPECT_EQ(a.tool_radius, b.tool_radius);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.stiffness, b.stiffness);
    ASSERT_EQ(a.regions.size(), b.regions.size());
    for (std::size_t i = 0; i < a.regions.size(); ++i)
        for_each_field(felt_region_fields, [&](const auto& field) {
            EXPECT_EQ(a.regions[i].*field.member, b.regions[i].*field.member) << field.name;
        });
}

std::map<std::string, double> figures(const Certificate& certificate) {
    std::map<std::string, double> figures;
    for_each_field(certificate_fields, [&](const auto& field) {
        figures[field.name] = static_cast<double>(certificate.*field.member);
    });
    return figures;
}

void expect_same(const DeformableBody& a, const DeformableBody& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.mesh.rest_positions, b.mesh.rest_positions);
    EXPECT_EQ(a.mesh.tetrahedra, b.mesh.tetrahedra);
    EXPECT_EQ(a.mesh.regions, b.mesh.regions);
    expect_same(a.mesh.region_names, b.mesh.region_names);
    EXPECT_EQ(a.mesh.outside_labels, b.mesh.outside_labels);
    expect_same(a.mesh.outside_names, b.mesh.outside_names);
    EXPECT_EQ(mechanics_digest(a), mechanics_digest(b));
    EXPECT_EQ(a.boundary.nodes, b.boundary.nodes);
    EXPECT_EQ(surface_digest(a.boundary.surface), surface_digest(b.boundary.surface));
    EXPECT_EQ(a.contact_nodes, b.contact_nodes);
    EXPECT_EQ(a.element_order, b.element_order);
    ASSERT_EQ(a.compliance.index(), b.compliance.index());
    std::visit(
        [&](const auto& compliance) {
            expect_same(compliance, std::get<std::decay_t<decltype(compliance)>>(b.compliance));
        },
        a.compliance);
    EXPECT_EQ(figures(a.certificate), figures(b.certificate));
    ASSERT_EQ(a.feel.has_value(), b.feel.has_value());
    if (a.feel) expect_same(*a.feel, *b.feel);
}

TEST(Asset, reading_returns_what_was_written) {
    const Scratch scratch;
    Case written = sample::sample_case(cells);
    written.haptics.grip = 0.02;
    write_asset(scratch / "case.vtkhdf", written);
    const Case read = read_asset(scratch / "case.vtkhdf");
    EXPECT_EQ(read.name, written.name);
    EXPECT_EQ(read.provenance, written.provenance);
    EXPECT_EQ(read.haptics.tool_radius, written.haptics.tool_radius);
    EXPECT_EQ(read.haptics.coupling_stiffness, written.haptics.coupling_stiffness);
    EXPECT_EQ(read.haptics.friction_sliding, written.haptics.friction_sliding);
    EXPECT_EQ(read.haptics.shaft_length, written.haptics.shaft_length);
    EXPECT_EQ(read.haptics.grip, written.haptics.grip);
    EXPECT_EQ(read.haptics.max_force, written.haptics.max_force);
    EXPECT_EQ(read.haptics.max_force_rate, written.haptics.max_force_rate);
    ASSERT_EQ(read.rigid_bodies.size(), 1U);
    EXPECT_EQ(read.rigid_bodies[0].name, "skull");
    EXPECT_EQ(surface_digest(read.rigid_bodies[0].surface), surface_digest(written.rigid_bodies[0].surface));
    expect_same(read.rigid_bodies[0].obb_tree, written.rigid_bodies[0].obb_tree);
    ASSERT_EQ(read.deformable_bodies.size(), 1U);
    expect_same(read.deformable_bodies[0], written.deformable_bodies[0]);
    expect_same(read.deformable_bodies[0].obb_tree, written.deformable_bodies[0].obb_tree);
}

TEST(Asset, may_hold_a_contact_surface_that_leaves_free_surface_out) {
    const Scratch scratch;
    Case written = sample::sample_case(cells);
    DeformableBody& body = written.deformable_bodies[0];
    std::erase_if(body.contact_nodes, [](std::int32_t node) { return node % 3 == 0; });
    body.compliance = sample::kernel_compliance(body.mesh, body.contact_nodes, 5.0, 1.0);
    body.feel = sample::made_up_feel(body, written.haptics.tool_radius);
    write_asset(scratch / "case.vtkhdf", written);
    expect_same(read_asset(scratch / "case.vtkhdf").deformable_bodies[0], body);
}

TEST(Asset, of_a_case_without_feel_says_nothing_of_it) {
    const Scratch scratch;
    Case written = sample::sample_case(cells);
    ASSERT_FALSE(written.deformable_bodies[0].feel->regions.empty());
    written.deformable_bodies[0].feel.reset();
    write_asset(scratch / "case.vtkhdf", written);
    EXPECT_FALSE(read_asset(scratch / "case.vtkhdf").deformable_bodies[0].feel);
    EXPECT_FALSE(Hdf5File(scratch / "case.vtkhdf").contains("/palpate/bodies/deformable/0/feel"));
}

TEST(Asset, refuses_a_feel_of_another_tool) {
    const Scratch scratch;
    Case other = sample::sample_case(cells);
    other.haptics.tool_radius = 2;
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", other); }),
                HasSubstr("wall: says what is felt with a tool of 1.500000 mm radius (expected 2.000000 mm"));
}

// Whatever the digests say.
TEST(Asset, refuses_a_feel_that_its_body_cannot_have_when_writing_and_when_reading) {
    const Scratch scratch;
    const DeformableBody body = sample::sample_case(cells).deformable_bodies[0];
    const auto held = static_cast<std::size_t>(std::ranges::find(body.feel->stiffness, 0.0F) -
                                               body.feel->stiffness.begin());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::pair<std::string, std::function<void(Feel&)>>> forgeries{
        {"tool_radius or depth", [](Feel& f) { f.tool_radius = -1; }},
        {"tool_radius or depth", [](Feel& f) { f.depth = std::numeric_limits<double>::infinity(); }},
        {"feel/stiffness", [](Feel& f) { f.stiffness.pop_back(); }},
        {"feel/stiffness: entry 97", [&](Feel& f) { f.stiffness[97] = nan; }},
        {"feel/stiffness: entry 97", [](Feel& f) { f.stiffness[97] = -0.01F; }},
        {"0 where there is no contact node", [&](Feel& f) { f.stiffness[held] = 0.01F; }},
        {"is of region 3", [](Feel& f) { f.regions[0].region = 3; }},
        {"region is 0", [](Feel& f) { f.regions[0].region = 0; }},
        {"ascending", [](Feel& f) { f.regions.push_back(f.regions[0]); }},
        {"another stiffness than its vertex", [](Feel& f) { f.regions[0].vertex = 98; }},
        {"vertex is -1", [](Feel& f) { f.regions[0].vertex = -1; }},
        {"another stiffness than its vertex", [](Feel& f) { f.regions[0].stiffness *= 1.01; }},
        {"stiffness_without is 0", [](Feel& f) { f.regions[0].stiffness_without = 0; }},
        {"depth is -0.5", [](Feel& f) { f.regions[0].depth = -0.5; }},
        {"variation is nan", [&](Feel& f) { f.regions[0].variation = static_cast<double>(nan); }}};
    for (const auto& [message, forge] : forgeries) {
        Feel forged = *body.feel;
        forge(forged);
        EXPECT_THAT(refusal([&] { check_feel(forged, body, "feel"); }), HasSubstr(message));
        {
            Hdf5Writer writer(scratch / "forged.h5");
            writer.group("/palpate");
            write_feel(writer, "/palpate/feel", forged);
            writer.finish("/palpate");
        }
        const Hdf5File file(scratch / "forged.h5");
        EXPECT_NE(refusal([&] { read_feel(file, "/palpate/feel", body); }), "") << message;
    }
}

TEST(Asset, may_hold_quadratic_elements) {
    const Scratch scratch;
    Case written = sample::sample_case(cells);
    written.deformable_bodies[0].element_order = ElementOrder::quadratic;
    write_asset(scratch / "case.vtkhdf", written);
    expect_same(read_asset(scratch / "case.vtkhdf").deformable_bodies[0], written.deformable_bodies[0]);
}

TEST(Asset, may_hold_a_compliance_by_blocks) {
    const Scratch scratch;
    Case written = sample::sample_case(cells);
    written.deformable_bodies = {hierarchical_cube()};
    write_asset(scratch / "case.vtkhdf", written);
    expect_same(read_asset(scratch / "case.vtkhdf").deformable_bodies[0], written.deformable_bodies[0]);
}

// One dense block: no factors at all.
TEST(Asset, may_hold_a_compliance_of_one_block) {
    const Scratch scratch;
    Case written = sample::sample_case(1);
    written.deformable_bodies = {sample::with_hierarchical_compliance(sample::elastic_cube(1), 0, 1e-4)};
    write_asset(scratch / "case.vtkhdf", written);
    expect_same(read_asset(scratch / "case.vtkhdf").deformable_bodies[0], written.deformable_bodies[0]);
}

TEST(Asset, may_lack_provenance_outside_labels_and_rigid_bodies) {
    const Scratch scratch;
    Case written = sample::sample_case(1);
    written.provenance.clear();
    written.rigid_bodies.clear();
    written.deformable_bodies[0].mesh.outside_labels.clear();
    written.deformable_bodies[0].mesh.outside_names.clear();
    write_asset(scratch / "case.vtkhdf", written);
    const Case read = read_asset(scratch / "case.vtkhdf");
    EXPECT_EQ(read.provenance, "");
    EXPECT_TRUE(read.deformable_bodies[0].mesh.outside_labels.empty());
}

TEST(Asset, a_name_outside_ascii_survives) {
    const Scratch scratch;
    Case written = sample::sample_case(1);
    written.rigid_bodies[0].name = "Schädel";
    write_asset(scratch / "case.vtkhdf", written);
    EXPECT_EQ(read_asset(scratch / "case.vtkhdf").rigid_bodies[0].name, "Schädel");
}

TEST(Asset, equal_cases_give_equal_bytes) {
    const Scratch scratch;
    write_asset(scratch / "a.vtkhdf", sample::sample_case(cells));
    write_asset(scratch / "b.vtkhdf", sample::sample_case(cells));
    EXPECT_EQ(sha256_file(scratch / "a.vtkhdf"), sha256_file(scratch / "b.vtkhdf"));
}

TEST(Asset, compliance_outlives_everything_else_that_was_read) {
    const Scratch scratch;
    write_asset(scratch / "case.vtkhdf", sample::sample_case(cells));
    const auto kept =
        std::get<DenseCompliance>(read_asset(scratch / "case.vtkhdf").deformable_bodies[0].compliance);
    std::filesystem::remove(scratch / "case.vtkhdf");
    EXPECT_EQ(kept.row(0)[0], 1.0F);  // the kernel at distance 0
}

TEST(Asset, compliance_by_blocks_outlives_everything_else_that_was_read) {
    const Scratch scratch;
    Case written = sample::sample_case(cells);
    written.deformable_bodies = {hierarchical_cube()};
    write_asset(scratch / "case.vtkhdf", written);
    const SurfaceCompliance kept = read_asset(scratch / "case.vtkhdf").deformable_bodies[0].compliance;
    std::filesystem::remove(scratch / "case.vtkhdf");
    const SurfaceCompliance& original = written.deformable_bodies[0].compliance;
    for (std::int32_t node = 0; node < node_count(original); ++node)
        EXPECT_EQ(compliance_block(kept, 0, node), compliance_block(original, 0, node));
}

TEST(Asset, values_of_a_compliance_are_mapped_not_copied) {
    const Scratch scratch;
    const auto path = scratch / "wall.body.h5";
    const auto lies_in = [](const Hdf5File& file, const void* values) {
        const std::span<const std::byte> bytes = file.mapping().bytes();
        return std::less_equal<>()(static_cast<const void*>(bytes.data()), values) &&
               std::less<>()(values, static_cast<const void*>(bytes.data() + bytes.size()));
    };
    write_body_part(path, hierarchical_cube());
    {
        const Hdf5File file(path);
        const DeformableBody body = read_condensed_body(file, "/palpate/body");
        const auto& blocks = std::get<HierarchicalCompliance>(body.compliance);
        EXPECT_TRUE(lies_in(file, blocks.values.get()));
        EXPECT_TRUE(lies_in(file, blocks.factors.get()));
    }
    write_body_part(path, sample::elastic_cube(cells));
    const Hdf5File file(path);
    const DeformableBody body = read_condensed_body(file, "/palpate/body");
    EXPECT_TRUE(lies_in(file, std::get<DenseCompliance>(body.compliance).entries.get()));
}

TEST(Asset, changed_attributes_are_covered_by_the_manifest) {
    const Scratch scratch;
    const auto path = scratch / "part.body.h5";
    {
        Hdf5Writer writer(path);
        write_header(writer, "body");
        const DeformableBody body = sample::elastic_cube(1);
        write_condensed_body(writer, "/palpate/body", body, mechanics_digest(body));
        writer.finish("/palpate");
    }
    const Hdf5File file(path);
    std::map<std::string, std::string> manifest;
    for (const auto& [name, object] : file.objects()) {
        if (object.values) manifest[name] = sha256(object.values->bytes);
        for (const auto& [key, value] : object.attributes)
            if (in_manifest(key)) manifest[name + '@' + key] = sha256(value.bytes);
    }
    EXPECT_EQ(manifest_digest(manifest), file.text_attribute("/palpate", "manifest_sha256"));
    EXPECT_TRUE(manifest.contains("/palpate/body/certificate@residual"));
    manifest["/palpate/body/certificate@residual"] = sha256(std::string_view("another"));
    EXPECT_NE(manifest_digest(manifest), file.text_attribute("/palpate", "manifest_sha256"));
}

TEST(Parts, reading_a_body_returns_what_was_written) {
    const Scratch scratch;
    DeformableBody written = sample::elastic_cube(cells);
    write_body_part(scratch / "wall.body.h5", written);
    expect_same(read_body_part(scratch / "wall.body.h5"), written);
    written.relaxation = {{1, {0.3, 0.5}}, {1, {0.2, 4}}, {2, {0.1, 1}}};
    write_body_part(scratch / "relaxing.body.h5", written);
    const DeformableBody read = read_body_part(scratch / "relaxing.body.h5");
    expect_same(read, written);
    EXPECT_EQ(relaxation_text(relaxation_of(read, 1)), "30 % in 0.5 s, 20 % in 4 s");
}

TEST(Parts, reading_a_body_with_a_compliance_by_blocks_returns_what_was_written) {
    const Scratch scratch;
    const DeformableBody written = hierarchical_cube();
    write_body_part(scratch / "wall.body.h5", written);
    expect_same(read_body_part(scratch / "wall.body.h5"), written);
}

TEST(LargeDeformation, is_read_as_it_was_written_and_takes_no_room_where_it_is_not_wanted) {
    const Scratch scratch;
    Case written = sample::sample_case(2);
    for (const bool large : {true, false}) {
        written.deformable_bodies[0].large_deformation = large;
        write_asset(scratch / "case.vtkhdf", written);
        EXPECT_EQ(read_asset(scratch / "case.vtkhdf").deformable_bodies[0].large_deformation, large);
        EXPECT_EQ(Hdf5File(scratch / "case.vtkhdf")
                      .has_attribute("/palpate/bodies/deformable/0", "large_deformation"),
                  large);
    }
}

TEST(LargeDeformation, that_is_neither_so_nor_not_is_refused_by_the_reader) {
    const Scratch scratch;
    {
        Hdf5Writer writer(scratch / "forged.h5");
        writer.group("/body");
        writer.attribute("/body", "large_deformation", std::int32_t{2});
        writer.close();
    }
    const Hdf5File file(scratch / "forged.h5");
    EXPECT_THAT(refusal([&] { read_large_deformation(file, "/body"); }),
                HasSubstr("/body: has large_deformation 2 (expected 0 or 1)"));
}

TEST(Parts, reading_an_obb_tree_returns_what_was_written) {
    const Scratch scratch;
    const TriangleMesh sphere = sample::sphere_surface({0, 0, 0}, 10, 2);
    const ObbTree tree = sample::median_tree(sphere, 2);
    write_obb_part(scratch / "skull.obb.h5", tree, sphere);
    expect_same(read_obb_part(scratch / "skull.obb.h5", sphere), tree);
}

TEST(Parts, an_obb_tree_of_another_surface_is_refused) {
    const Scratch scratch;
    TriangleMesh sphere = sample::sphere_surface({0, 0, 0}, 10, 2);
    write_obb_part(scratch / "skull.obb.h5", sample::median_tree(sphere, 2), sphere);
    sphere.vertices[7].x() += 1e-12;
    EXPECT_THAT(refusal([&] { read_obb_part(scratch / "skull.obb.h5", sphere); }),
                HasSubstr("was built over another surface; run 'palpate obb'"));
}

TEST(Parts, a_compliance_of_another_modulus_mesh_or_boundary_is_refused) {
    const Scratch scratch;
    DeformableBody body = sample::elastic_cube(cells);
    body.contact_nodes.erase(body.contact_nodes.begin());  // a node of the surface that C leaves out
    body.compliance = sample::kernel_compliance(body.mesh, body.contact_nodes, 5.0, 1.0);
    for (const auto& change : std::vector<std::function<void(DeformableBody&)>>{
             [](DeformableBody& b) { b.materials[0].material.youngs_modulus *= 1 + 1e-15; },
             [](DeformableBody& b) {
                 b.relaxation = {{1, {0.3, 1}}};
             },
             [](DeformableBody& b) { b.mesh.rest_positions.back().x() += 1e-9; },
             [](DeformableBody& b) { b.mesh.regions[0] = 2; },
             [](DeformableBody& b) { b.fixed_nodes.pop_back(); },
             [](DeformableBody& b) { --b.contact_nodes.front(); },  // that node in its neighbour's place
             [](DeformableBody& b) { b.element_order = ElementOrder::quadratic; }}) {
        DeformableBody changed = body;
        change(changed);
        {
            Hdf5Writer writer(scratch / "mixed.body.h5");
            write_header(writer, "body");
            write_condensed_body(writer, "/palpate/body", changed, mechanics_digest(body));
            writer.finish("/palpate");
        }
        EXPECT_THAT(refusal([&] { read_body_part(scratch / "mixed.body.h5"); }),
                    HasSubstr("was condensed from another mesh, material or boundary"));
    }
}

}  // namespace
}  // namespace palpate
