// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fmt/format.h>
#include <unordered_map>

#include "tools/meshing/files/found_mesh.hpp"
#include "tools/meshing/files/scanner.hpp"

namespace palpate::meshing {
namespace {

constexpr int linear_tetrahedron = 4;

struct ElementType {
    int nodes, dimension;
    const char* name;
};

// Gmsh's numbers of the element types that it writes.
const std::map<std::int64_t, ElementType> element_types{{1, {2, 1, "line"}},
                                                        {2, {3, 2, "triangle"}},
                                                        {3, {4, 2, "quadrangle"}},
                                                        {4, {4, 3, "tetrahedron"}},
                                                        {5, {8, 3, "hexahedron"}},
                                                        {6, {6, 3, "prism"}},
                                                        {7, {5, 3, "pyramid"}},
                                                        {8, {3, 1, "second-order line"}},
                                                        {9, {6, 2, "second-order triangle"}},
                                                        {10, {9, 2, "second-order quadrangle"}},
                                                        {11, {10, 3, "second-order tetrahedron"}},
                                                        {12, {27, 3, "second-order hexahedron"}},
                                                        {13, {18, 3, "second-order prism"}},
                                                        {14, {14, 3, "second-order pyramid"}},
                                                        {15, {1, 0, "point"}},
                                                        {16, {8, 2, "second-order quadrangle"}},
                                                        {17, {20, 3, "second-order hexahedron"}},
                                                        {18, {15, 3, "second-order prism"}},
                                                        {19, {13, 3, "second-order pyramid"}},
                                                        {21, {10, 2, "third-order triangle"}},
                                                        {26, {4, 1, "third-order line"}},
                                                        {29, {20, 3, "third-order tetrahedron"}}};

// Words in ASCII files, the machine's bytes in binary ones.
class GmshReader {
  public:
    explicit GmshReader(const std::filesystem::path& path) : file_(path) {}

    FoundTetrahedra read() {
        while (!file_.at_end()) {
            const std::string section(file_.word());
            if (section == "$MeshFormat") read_format();
            if (section == "$PhysicalNames") read_names();
            if (section == "$Entities") read_entities();
            if (section == "$NOD" || section == "$Nodes") read_nodes();
            if (section == "$ELM" || section == "$Elements") read_elements();
            if (!section.starts_with('$'))
                file_.fail(fmt::format("'{}'", section.substr(0, 40)),
                           "a section of a Gmsh file, such as $Nodes", "write it again as version 4.1");
            const std::string end = section == "$NOD" || section == "$ELM" ? "$END" : "$End";
            if (!file_.skip_to(end + section.substr(1)))
                file_.fail("section " + section + " has no end", end + section.substr(1), "write it again");
        }
        settle_regions();
        return std::move(found_);
    }

  private:
    std::int64_t small() { return binary_ ? file_.raw<std::int32_t>() : file_.integer(); }
    std::int64_t large() {
        return binary_ ? static_cast<std::int64_t>(file_.raw<std::uint64_t>()) : file_.integer();
    }
    double real() { return binary_ ? file_.raw<double>() : file_.number(); }
    bool blocks() const { return version_ >= 4; }

    void read_format() {
        version_ = file_.number();
        const std::int64_t kind = file_.integer(), size = file_.integer();
        if (version_ != 2 && version_ != 2.1 && version_ != 2.2 && version_ != 4.1)
            file_.fail(fmt::format("Gmsh format {}", version_), "1, 2.2 or 4.1",
                       "save it with 'gmsh -0 FILE -format msh41 -o NEW.msh'");
        if (kind == 0) return;
        file_.line();
        if (size != 8 || file_.raw<std::int32_t>() != 1)
            file_.fail("binary data of another machine", "8 bytes a number, lowest first",
                       "save it as ASCII: 'gmsh -0 FILE -format msh41 -o NEW.msh'");
        binary_ = true;
    }

    void read_names() {
        for (std::int64_t left = file_.count(); left > 0; --left) {
            const std::int64_t dimension = file_.integer(), value = file_.integer();
            const std::string name(file_.quoted());
            if (dimension != 3) continue;
            const std::int32_t group = file_.narrow(value, "physical group");
            found_.names.push_back({group, name, default_label_colour(group)});
        }
    }

    // Version 4.1: which physical group each volume is in.
    void read_entities() {
        if (binary_) file_.line();
        std::array<std::int64_t, 4> counts{};
        for (std::int64_t& count : counts) count = file_.require_room(large(), 2);
        for (int dimension = 0; dimension < 4; ++dimension)
            for (std::int64_t left = counts[dimension]; left > 0; --left) {
                const std::int64_t tag = small();
                for (int n = 0; n < (dimension == 0 ? 3 : 6); ++n) real();
                for (std::int64_t groups = large(), n = 0; n < groups; ++n)
                    if (const std::int64_t group = small(); dimension == 3)
                        physical_of_.try_emplace(tag, group);
                if (dimension > 0)
                    for (std::int64_t bounds = large(), n = 0; n < bounds; ++n) small();
            }
    }

    void add_node(std::int64_t tag, const Eigen::Vector3d& point) {
        if (!index_of_.emplace(tag, static_cast<std::int32_t>(found_.points.size())).second)
            file_.fail(fmt::format("node {} is there twice", tag), "one node of each number",
                       "write it again");
        found_.points.push_back(point);
    }

    Eigen::Vector3d point() {
        Eigen::Vector3d p;
        for (double& x : p) x = real();
        return p;
    }

    void read_nodes() {
        if (!blocks()) {
            std::int64_t left = file_.count();
            if (binary_) file_.line();
            for (; left > 0; --left) {
                const std::int64_t tag = small();
                add_node(tag, point());
            }
            return;
        }
        if (binary_) file_.line();
        std::int64_t left = large();
        for (int n = 0; n < 3; ++n) large();
        for (; left > 0; --left) {
            const std::int64_t dimension = small();
            small();
            const bool parametric = small() != 0;
            std::vector<std::int64_t> tags(static_cast<std::size_t>(file_.require_room(large(), 2)));
            for (std::int64_t& tag : tags) tag = large();
            for (const std::int64_t tag : tags) {
                add_node(tag, point());
                if (parametric)
                    for (std::int64_t n = 0; n < dimension; ++n) real();
            }
        }
    }

    const ElementType& type(std::int64_t number) const {
        const auto found = element_types.find(number);
        if (found == element_types.end())
            file_.fail(fmt::format("elements of Gmsh type {}", number), "linear tetrahedra, type 4",
                       "save it with Mesh.ElementOrder = 1");
        return found->second;
    }

    template <typename NextNode>
    void add_element(std::int64_t number, std::int64_t physical, std::int64_t entity, NextNode&& next_node) {
        const ElementType& element = type(number);
        if (number != linear_tetrahedron) {
            ++(element.dimension == 3 ? found_.solid : found_.flat)[element.name];
            for (int n = 0; n < element.nodes; ++n) next_node();
            return;
        }
        Tetrahedron tet{};
        for (std::int32_t& node : tet) {
            const std::int64_t tag = next_node();
            const auto known = index_of_.find(tag);
            if (known == index_of_.end())
                file_.fail(fmt::format("a tetrahedron names node {}", tag), "a node of the file",
                           "write it again");
            node = known->second;
        }
        found_.tetrahedra.push_back(tet);
        physical_.push_back(file_.narrow(physical, "physical group"));
        entity_.push_back(file_.narrow(entity, "geometrical entity"));
    }

    void read_elements() {
        if (blocks())
            read_element_blocks();
        else if (binary_)
            read_binary_elements();
        else
            for (std::int64_t left = file_.count(); left > 0; --left) {
                file_.integer();  // its number
                const std::int64_t number = file_.integer();
                std::array<std::int64_t, 2> tags{};  // physical group, geometrical entity
                const std::int64_t count = version_ == 1 ? 2 : file_.integer();
                for (std::int64_t n = 0; n < count; ++n)
                    if (const auto tag = file_.integer(); n < 2) tags[n] = tag;
                if (version_ == 1 && file_.integer() != type(number).nodes)
                    file_.fail("an element with another number of nodes than its type has", "",
                               "write it again");
                add_element(number, tags[0], tags[1], [&] { return file_.integer(); });
            }
    }

    void read_binary_elements() {
        std::int64_t left = file_.count();
        file_.line();
        while (left > 0) {
            const std::int64_t number = small(), count = file_.require_room(small(), 4), tag_count = small();
            if (count == 0 || count > left)
                file_.fail("a block of elements of the wrong size", "", "write it again");
            for (std::int64_t n = 0; n < count; ++n) {
                small();
                std::array<std::int64_t, 2> tags{};
                for (std::int64_t t = 0; t < tag_count; ++t)
                    if (const auto tag = small(); t < 2) tags[t] = tag;
                add_element(number, tags[0], tags[1], [&] { return small(); });
            }
            left -= count;
        }
    }

    void read_element_blocks() {
        if (binary_) file_.line();
        std::int64_t left = large();
        for (int n = 0; n < 3; ++n) large();
        for (; left > 0; --left) {
            small();
            const std::int64_t entity = small(), number = small();
            const auto group = physical_of_.find(entity);
            const std::int64_t physical = group == physical_of_.end() ? 0 : group->second;
            for (std::int64_t count = file_.require_room(large(), 4); count > 0; --count) {
                large();
                add_element(number, physical, entity, [&] { return large(); });
            }
        }
    }

    void settle_regions() {
        const bool grouped = std::ranges::any_of(physical_, [](std::int32_t group) { return group > 0; });
        found_.regions = std::move(grouped ? physical_ : entity_);
        found_.regions_from = grouped ? "physical groups" : "geometrical entities";
        if (!grouped) found_.names.clear();
    }

    Scanner file_;
    FoundTetrahedra found_;
    double version_ = 1;
    bool binary_ = false;
    std::unordered_map<std::int64_t, std::int32_t> index_of_;     // of a node's number
    std::unordered_map<std::int64_t, std::int64_t> physical_of_;  // of a volume's number
    std::vector<std::int32_t> physical_, entity_;                 // of each tetrahedron
};

}  // namespace

FoundTetrahedra read_gmsh(const std::filesystem::path& path) {
    return GmshReader(path).read();
}

}  // namespace palpate::meshing
