// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellTypes.h>
#include <vtkGenericCell.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/found_mesh.hpp"
#include "tools/meshing/files/imported_placement.hpp"
#include "tools/meshing/files/vtk/vtk_reading.hpp"
#include "tools/meshing/files/vtk/xml_readers.hpp"

namespace palpate::meshing {
namespace {

// "vtkQuadraticTetra" is "quadratic tetra" to people.
std::string cell_kind(int type) {
    std::string name;
    for (const char c : std::string(vtkCellTypes::GetClassNameFromTypeId(type)).substr(3)) {
        const bool capital = c >= 'A' && c <= 'Z';
        if (capital && !name.empty()) name += ' ';
        name += capital ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return name;
}

FoundTetrahedra from_grid(vtkUnstructuredGrid* grid, const std::filesystem::path& path) {
    FoundTetrahedra found;
    found.space = space_of(grid);
    found.points = read_points(grid->GetPoints(), path);
    std::optional<std::vector<std::int32_t>> regions;
    for (const char* name : {"region", "medit:ref", "gmsh:physical", "gmsh:geometrical"}) {
        regions = read_integers(grid->GetCellData(), name, static_cast<std::size_t>(grid->GetNumberOfCells()),
                                path);
        if (!regions) continue;
        found.regions_from = fmt::format("cell array '{}'", name);
        break;
    }
    found.names = read_labels(grid, "region");
    if (!grid->GetCells() || !grid->GetCells()->IsValid())
        throw InvalidInput({path.string(), "its cell offsets are inconsistent", "", "write it again"});
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
        vtkIdType corners = 0;
        const vtkIdType* nodes = nullptr;
        grid->GetCellPoints(cell, corners, nodes);
        const int type = grid->GetCellType(cell);
        if (type != VTK_TETRA || corners != 4) {
            const auto shape = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
            const bool solid = shape && shape->GetCellDimension() == 3;
            ++(solid ? found.solid : found.flat)[cell_kind(type)];
            continue;
        }
        Tetrahedron tet{};
        for (std::size_t c = 0; c < 4; ++c) {
            if (nodes[c] < 0 || static_cast<std::size_t>(nodes[c]) >= found.points.size())
                throw InvalidInput({path.string(), fmt::format("cell {} names point {}", cell, nodes[c]),
                                    fmt::format("0 ... {} - 1", found.points.size()), "write it again"});
            tet[c] = static_cast<std::int32_t>(nodes[c]);
        }
        found.tetrahedra.push_back(tet);
        if (regions) found.regions.push_back((*regions)[cell]);
    }
    return found;
}

}  // namespace

FoundTetrahedra read_vtk_grid(const std::filesystem::path& path) {
    if (extension_of(path) == ".vtu") {
        vtkNew<XmlGridReader> reader;
        read_with(*reader, path, "VTK UnstructuredGrid file (.vtu)");
        return from_grid(reader->GetOutput(), path);
    }
    vtkNew<vtkUnstructuredGridReader> reader;
    read_with(*reader, path, "legacy VTK file with an unstructured grid");
    return from_grid(reader->GetOutput(), path);
}

}  // namespace palpate::meshing
