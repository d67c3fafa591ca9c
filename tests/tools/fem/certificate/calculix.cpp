// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/certificate/calculix.hpp"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

class ScratchFolder {
  public:
    ScratchFolder() {
        std::string name = fs::temp_directory_path() / "palpate-calculix-XXXXXX";
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder " + name);
        path_ = name;
    }
    ~ScratchFolder() { fs::remove_all(path_); }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

// ccx counts from 1 and orders C3D10's middle nodes 12 23 13 14 24 34 (CalculiX CrunchiX manual, "Ten-node
// tetrahedral element"), which is the order of Discretisation::elements.
void write_deck(const fs::path& path, const ElasticSystem& system, const Supports& supports) {
    std::ofstream deck(path);
    deck << "*NODE, NSET=ALL\n";
    for (std::size_t node = 0; node < system.positions.size(); ++node) {
        const Eigen::Vector3d& p = system.positions[node];
        deck << fmt::format("{},{:.12e},{:.12e},{:.12e}\n", node + 1, p.x(), p.y(), p.z());
    }
    const auto per_element = static_cast<std::size_t>(system.discretisation.nodes_per_element);
    for (const auto& [region, material] : system.body.materials) {
        deck << fmt::format("*ELEMENT, TYPE=C3D{}, ELSET=R{}\n", per_element, region);
        for (std::size_t t = 0; t < system.body.mesh.tetrahedra.size(); ++t) {
            if (system.body.mesh.regions[t] != region) continue;
            deck << t + 1;
            for (std::size_t a = 0; a < per_element; ++a)
                deck << ',' << system.discretisation.elements[per_element * t + a] + 1;
            deck << '\n';
        }
        deck << fmt::format(
            "*MATERIAL, NAME=M{0}\n*ELASTIC\n{1:.12e},{2:.12e}\n*SOLID SECTION, ELSET=R{0}, MATERIAL=M{0}\n",
            region, material.youngs_modulus, material.poissons_ratio);
    }
    deck << "*STEP\n*STATIC\n*BOUNDARY\n";
    for (std::size_t dof = 0; dof < supports.held.size(); ++dof)
        if (supports.held[dof])
            deck << fmt::format("{},{},{},{:.12e}\n", dof / 3 + 1, dof % 3 + 1, dof % 3 + 1,
                                supports.values[static_cast<Eigen::Index>(dof)]);
    deck << "*NODE PRINT, NSET=ALL\nU, RF\n*END STEP\n";
}

// The .dat file has one table per quantity: a title line, an empty one, then "node x y z".
Eigen::VectorXd read_table(const std::string& table, Eigen::Index dofs) {
    Eigen::VectorXd values = Eigen::VectorXd::Constant(dofs, std::nan(""));
    std::istringstream lines(table.substr(table.find('\n')));
    Eigen::Index node = 0;
    Eigen::Vector3d row;
    while (lines >> node >> row.x() >> row.y() >> row.z()) values.segment<3>(3 * (node - 1)) = row;
    if (!values.allFinite()) throw std::runtime_error("ccx left out nodes");
    return values;
}

std::string text_of(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

}  // namespace

bool calculix_is_installed() {
    return std::system("command -v ccx >/dev/null 2>&1") == 0;
}

CalculixAnswer ask_calculix(const ElasticSystem& system, const Supports& supports) {
    const ScratchFolder folder;
    write_deck(folder.path() / "press.inp", system, supports);
    const std::string command = "cd '" + folder.path().string() + "' && ccx press >talk.txt 2>&1";
    const int status = std::system(command.c_str());
    const std::string answer = text_of(folder.path() / "press.dat");
    const std::size_t displacements = answer.find(" displacements"), forces = answer.find(" forces");
    if (status != 0 || displacements == std::string::npos || forces == std::string::npos)
        throw std::runtime_error("ccx gave no answer:\n" + text_of(folder.path() / "talk.txt"));
    return {read_table(answer.substr(displacements, forces - displacements), system.dof_count()),
            read_table(answer.substr(forces), system.dof_count())};
}

}  // namespace palpate::test
