// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: typed access to a recipe's parameters with their defaults.
#pragma once
#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/recipes/segmentation.hpp"

namespace palpate::imaging {

/// A structure's parameters, checked on construction as check_recipe() does; absent ones take their default.
class Parameters {
  public:
    explicit Parameters(const StructureRecipe& structure);

    /// Throw InvalidInput if the parameter is absent and has no default.
    double number(const std::string& name) const;
    std::string text(const std::string& name) const;
    bool flag(const std::string& name) const;
    Eigen::Vector3d point(const std::string& name) const;
    /// Points x, y, z; none if absent.
    std::vector<Eigen::Vector3d> points(const std::string& name) const;
    bool has(const std::string& name) const;

  private:
    const RecipeValue& value(const std::string& name) const;

    std::string structure_;
    std::map<std::string, RecipeValue> values_;
};

}  // namespace palpate::imaging
