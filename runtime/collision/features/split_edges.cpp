// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/features/split_edges.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

namespace palpate::collision {
namespace {

// One round: every long edge is halved once.
class Halving {
  public:
    Halving(const TriangleMesh& mesh, double longest)
        : vertices_(mesh.vertices), squared_longest_(longest * longest) {
        for (const Triangle& t : mesh.triangles) split(t);
    }

    TriangleMesh result() && { return {std::move(vertices_), std::move(triangles_)}; }
    bool halved() const { return !middles_.empty(); }

  private:
    const Eigen::Vector3d& at(std::int32_t v) const { return vertices_[static_cast<std::size_t>(v)]; }

    std::optional<std::int32_t> middle_of(std::int32_t a, std::int32_t b) {
        const std::pair edge(std::min(a, b), std::max(a, b));
        if ((at(edge.first) - at(edge.second)).squaredNorm() <= squared_longest_) return std::nullopt;
        const auto [place, is_new] = middles_.try_emplace(edge, static_cast<std::int32_t>(vertices_.size()));
        if (is_new) vertices_.push_back(0.5 * (at(edge.first) + at(edge.second)));
        return place->second;
    }

    // The corners and middles around the triangle; an ear with a halved edge on both sides is cut off first.
    void split(const Triangle& t) {
        std::array<std::int32_t, 6> around{};
        std::array<bool, 6> is_corner{};
        std::size_t count = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            is_corner[count] = true;
            around[count++] = t[i];
            if (const auto middle = middle_of(t[i], t[(i + 1) % 3])) around[count++] = *middle;
        }
        const auto cut = [&](std::size_t i) {
            triangles_.push_back({around[(i + count - 1) % count], around[i], around[(i + 1) % count]});
            for (std::size_t k = i; k + 1 < count; ++k) {
                around[k] = around[k + 1];
                is_corner[k] = is_corner[k + 1];
            }
            --count;
        };
        while (count > 3) {
            std::size_t ear = 0;
            while (ear < count && !(is_corner[ear] && !is_corner[(ear + 1) % count] &&
                                    !is_corner[(ear + count - 1) % count]))
                ++ear;
            // With one middle left, the halves lie on either side of the line from it to the corner across.
            if (ear == count) ear = (first_middle(is_corner, count) + 1) % count;
            cut(ear);
        }
        cut(1);
    }

    static std::size_t first_middle(const std::array<bool, 6>& is_corner, std::size_t count) {
        return static_cast<std::size_t>(std::find(is_corner.begin(), is_corner.begin() + count, false) -
                                        is_corner.begin());
    }

    std::vector<Eigen::Vector3d> vertices_;
    std::vector<Triangle> triangles_;
    double squared_longest_;
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles_;
};

}  // namespace

TriangleMesh split_long_edges(const TriangleMesh& mesh, double longest, std::size_t most) {
    TriangleMesh split = mesh;
    while (true) {
        Halving halving(split, longest);
        if (!halving.halved()) return split;
        TriangleMesh finer = std::move(halving).result();
        if (finer.triangles.size() > most) return split;
        split = std::move(finer);
    }
}

}  // namespace palpate::collision
