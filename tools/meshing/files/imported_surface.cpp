// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fstream>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkTriangleFilter.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/imported_placement.hpp"
#include "tools/meshing/files/obj_file.hpp"
#include "tools/meshing/files/ply_file.hpp"
#include "tools/meshing/files/stl_file.hpp"
#include "tools/meshing/files/surface_repair.hpp"
#include "tools/meshing/files/vtk/vtk_reading.hpp"
#include "tools/meshing/files/vtk/xml_readers.hpp"
#include "tools/meshing/surfaces/joined_vertices.hpp"

namespace palpate::meshing {
namespace {

template <typename Reader>
vtkSmartPointer<vtkPolyData> read_as(const std::filesystem::path& path, const char* kind) {
    vtkNew<Reader> reader;
    read_with(*reader, path, kind);
    return reader->GetOutput();
}

vtkSmartPointer<vtkPolyData> read_polygons(const std::filesystem::path& path, const NoteSink& note) {
    const std::string extension = extension_of(path);
    if (extension == ".vtp") return read_as<XmlSurfaceReader>(path, "VTK PolyData file (.vtp)");
    if (extension == ".vtk") return read_as<vtkPolyDataReader>(path, "legacy VTK file with polygons");
    if (extension == ".stl")
        return read_stl(path, [&](std::string_view text) {
            if (note) note(fmt::format("{}: {}", path.string(), text));
        });
    if (extension == ".obj") return read_obj(path);
    if (extension == ".ply") return read_ply(path);
    throw InvalidInput({path.string(), "has the extension '" + extension + "'",
                        ".vtp, .vtk, .stl, .obj or .ply",
                        "convert it, for example with meshio or 3D Slicer"});
}

// VTK's filters trust indices; files do not deserve it.
void require_indices(vtkCellArray* cells, vtkIdType points, const std::string& culprit) {
    if (!cells->IsValid())
        throw InvalidInput({culprit, "its cell offsets are inconsistent", "", "write it again"});
    for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell) {
        vtkIdType corners = 0;
        const vtkIdType* nodes = nullptr;
        cells->GetCellAtId(cell, corners, nodes);
        for (vtkIdType c = 0; c < corners; ++c)
            if (nodes[c] < 0 || nodes[c] >= points)
                throw InvalidInput({culprit, fmt::format("cell {} names point {}", cell, nodes[c]),
                                    fmt::format("0 ... {} - 1", points), "write it again"});
    }
}

// 3D Slicer writes SPACE=LPS or SPACE=RAS into headers and comments.
std::string stated_frame(vtkPolyData* data, const std::filesystem::path& path) {
    if (const std::string space = space_of(data); !space.empty()) return space;
    std::string head(1024, '\0');
    std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
    for (const char* frame : {"LPS", "RAS"})
        if (head.find(std::string("SPACE=") + frame) != std::string::npos) return frame;
    return "";
}

}  // namespace

TriangleMesh read_unrepaired_surface(const std::filesystem::path& path, const ImportedMeshOptions& options,
                                     const NoteSink& note) {
    const std::string culprit = path.string();
    const vtkSmartPointer<vtkPolyData> data = read_polygons(path, note);
    for (vtkCellArray* cells : {data->GetPolys(), data->GetStrips()})
        require_indices(cells, data->GetNumberOfPoints(), culprit);
    const std::map<std::string, std::int64_t> flat{{"line", data->GetNumberOfLines()},
                                                   {"point", data->GetNumberOfVerts()}};
    for (const auto& [kind, count] : flat)
        if (count > 0 && note) note(fmt::format("{}: ignored {}", culprit, listed({{kind, count}})));
    vtkNew<vtkTriangleFilter> triangulation;
    triangulation->SetInputData(data);
    triangulation->PassVertsOff();
    triangulation->PassLinesOff();
    triangulation->Update();
    vtkPolyData* triangles = triangulation->GetOutput();
    if (const auto more = triangles->GetNumberOfPolys() - data->GetNumberOfPolys(); more > 0 && note)
        note(fmt::format("{}: {} polygons or strips split into {} triangles", culprit,
                         data->GetNumberOfPolys() + data->GetNumberOfStrips(),
                         triangles->GetNumberOfPolys()));

    TriangleMesh surface;
    surface.vertices = read_points(triangles->GetPoints(), path);
    place(surface.vertices, options, stated_frame(data, path), culprit, note);
    for (vtkIdType t = 0; t < triangles->GetNumberOfPolys(); ++t) {
        vtkIdType corners = 0;
        const vtkIdType* nodes = nullptr;
        triangles->GetPolys()->GetCellAtId(t, corners, nodes);
        surface.triangles.push_back({static_cast<std::int32_t>(nodes[0]), static_cast<std::int32_t>(nodes[1]),
                                     static_cast<std::int32_t>(nodes[2])});
    }
    return surface;
}

TriangleMesh read_imported_surface(const std::filesystem::path& path, const ImportedMeshOptions& options,
                                   const NoteSink& note) {
    return repaired_surface(joined_vertices(read_unrepaired_surface(path, options, note)), path.string(),
                            note);
}

}  // namespace palpate::meshing
