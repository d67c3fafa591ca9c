// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/certificate/calculix.hpp"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>
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

using LawOfMaterial = std::function<std::string(const Material&)>;

// Nodes, elements and materials. ccx counts from 1 and orders C3D10's middle nodes 12 23 13 14 24 34
// (CalculiX CrunchiX manual, "Ten-node tetrahedral element"), which is the order of Discretisation::elements.
void write_body(std::ofstream& deck, const DeformableBody& body,
                const elasticity::Discretisation& discretisation, const Points& positions,
                const LawOfMaterial& law) {
    deck << "*NODE, NSET=ALL\n";
    for (std::size_t node = 0; node < positions.size(); ++node) {
        const Eigen::Vector3d& p = positions[node];
        deck << fmt::format("{},{:.12e},{:.12e},{:.12e}\n", node + 1, p.x(), p.y(), p.z());
    }
    const auto per_element = static_cast<std::size_t>(discretisation.nodes_per_element);
    for (const auto& [region, material] : body.materials) {
        deck << fmt::format("*ELEMENT, TYPE=C3D{}, ELSET=R{}\n", per_element, region);
        for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
            if (body.mesh.regions[t] != region) continue;
            deck << t + 1;
            for (std::size_t a = 0; a < per_element; ++a)
                deck << ',' << discretisation.elements[per_element * t + a] + 1;
            deck << '\n';
        }
        deck << fmt::format("*MATERIAL, NAME=M{0}\n{1}\n*SOLID SECTION, ELSET=R{0}, MATERIAL=M{0}\n", region,
                            law(material));
    }
}

std::string hookes_law(const Material& material) {
    return fmt::format("*ELASTIC\n{:.12e},{:.12e}", material.youngs_modulus, material.poissons_ratio);
}

// W = C10 (I1 - 3) + (J - 1)^2 / D1, I1 that of the deformation without its change of volume.
std::string neo_hookes_law(const Material& material) {
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    return fmt::format("*HYPERELASTIC, NEO HOOKE\n{:.12e},{:.12e}", e / (4 * (1 + nu)), 6 * (1 - 2 * nu) / e);
}

void write_deck(const fs::path& path, const ElasticSystem& system, const Supports& supports) {
    std::ofstream deck(path);
    write_body(deck, system.body, system.discretisation, system.positions, hookes_law);
    deck << "*STEP\n*STATIC\n*BOUNDARY\n";
    for (std::size_t dof = 0; dof < supports.held.size(); ++dof)
        if (supports.held[dof])
            deck << fmt::format("{},{},{},{:.12e}\n", dof / 3 + 1, dof % 3 + 1, dof % 3 + 1,
                                supports.values[static_cast<Eigen::Index>(dof)]);
    deck << "*NODE PRINT, NSET=ALL\nU, RF\n*END STEP\n";
}

// By default ccx is content with forces that are off by half a per cent.
void write_large_deck(const fs::path& path, const DeformableBody& body, const Eigen::VectorXd& forces) {
    std::ofstream deck(path);
    const elasticity::Discretisation discretisation = elasticity::discretise(body);
    Points positions = body.mesh.rest_positions;
    for (const auto& [a, b] : discretisation.edges)
        positions.emplace_back(
            (positions[static_cast<std::size_t>(a)] + positions[static_cast<std::size_t>(b)]) / 2);
    write_body(deck, body, discretisation, positions, neo_hookes_law);
    deck << "*STEP, NLGEOM, INC=200\n*STATIC\n0.25,1.,1e-6,0.5\n*CONTROLS, PARAMETERS=FIELD\n1e-7,1e-6\n"
            "*BOUNDARY\n";
    for (const std::int32_t node : discretisation.fixed_nodes) deck << fmt::format("{},1,3,0.\n", node + 1);
    deck << "*CLOAD\n";
    for (Eigen::Index dof = 0; dof < forces.size(); ++dof)
        if (forces[dof] != 0) deck << fmt::format("{},{},{:.12e}\n", dof / 3 + 1, dof % 3 + 1, forces[dof]);
    deck << "*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n*END STEP\n";
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

// Runs ccx on the deck that `write` writes; what its .dat file says.
std::string answer_to(const std::function<void(const fs::path&)>& write) {
    const ScratchFolder folder;
    write(folder.path() / "press.inp");
    const std::string command = "cd '" + folder.path().string() + "' && ccx press >talk.txt 2>&1";
    const int status = std::system(command.c_str());
    const std::string answer = text_of(folder.path() / "press.dat"),
                      talk = text_of(folder.path() / "talk.txt");
    if (status != 0 || talk.find("Job finished") == std::string::npos ||
        answer.find(" displacements") == std::string::npos)
        throw std::runtime_error("ccx gave no answer:\n" + talk);
    return answer;
}

}  // namespace

bool calculix_is_installed() {
    return std::system("command -v ccx >/dev/null 2>&1") == 0;
}

CalculixAnswer ask_calculix(const ElasticSystem& system, const Supports& supports) {
    const std::string answer = answer_to([&](const fs::path& path) { write_deck(path, system, supports); });
    const std::size_t displacements = answer.find(" displacements"), forces = answer.find(" forces");
    if (forces == std::string::npos) throw std::runtime_error("ccx left out forces");
    return {read_table(answer.substr(displacements, forces - displacements), system.dof_count()),
            read_table(answer.substr(forces), system.dof_count())};
}

Eigen::VectorXd ask_calculix_neo_hookean(const DeformableBody& body, const Eigen::VectorXd& forces) {
    const std::string answer = answer_to([&](const fs::path& path) { write_large_deck(path, body, forces); });
    return read_table(answer.substr(answer.rfind(" displacements")), forces.size());
}

}  // namespace palpate::test
