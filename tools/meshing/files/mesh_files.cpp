// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/mesh_files.hpp"

#include <algorithm>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/vtk/vtk_reading.hpp"
#include "tools/meshing/files/vtk/xml_readers.hpp"

namespace palpate::meshing {
namespace {

namespace fs = std::filesystem;

template <typename Writer>
void write_file(Writer* writer, vtkDataObject* data, const fs::path& path) {
    VtkErrorListener listener;
    writer->AddObserver(vtkCommand::ErrorEvent, listener.command());
    writer->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, listener.command());
    writer->SetInputData(data);
    writer->SetFileName(path.c_str());
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToZLib();
    const bool written = writer->Write() == 1;
    if (!written || listener.failed() || writer->GetErrorCode() != vtkErrorCode::NoError)
        throw SystemFailure(
            {path.string(), "could not be written", "", "check free space and permissions of its folder"});
}

vtkNew<vtkPoints> make_points(const std::vector<Eigen::Vector3d>& positions) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(static_cast<vtkIdType>(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i)
        points->SetPoint(static_cast<vtkIdType>(i), positions[i].data());
    return points;
}

template <std::size_t Corners>
vtkNew<vtkCellArray> make_cells(const std::vector<std::array<std::int32_t, Corners>>& cells) {
    vtkNew<vtkTypeInt32Array> offsets, connectivity;
    offsets->SetNumberOfValues(static_cast<vtkIdType>(cells.size()) + 1);
    connectivity->SetNumberOfValues(static_cast<vtkIdType>(Corners * cells.size()));
    for (std::size_t i = 0; i <= cells.size(); ++i)
        offsets->SetValue(static_cast<vtkIdType>(i), static_cast<vtkTypeInt32>(Corners * i));
    for (std::size_t i = 0; i < cells.size(); ++i)
        for (std::size_t corner = 0; corner < Corners; ++corner)
            connectivity->SetValue(static_cast<vtkIdType>(Corners * i + corner), cells[i][corner]);
    vtkNew<vtkCellArray> array;
    array->SetData(offsets, connectivity);
    return array;
}

template <std::size_t Corners>
std::vector<std::array<std::int32_t, Corners>> read_cells(vtkCellArray* array, std::size_t points,
                                                          const char* shape, const fs::path& path) {
    const std::size_t count = array ? static_cast<std::size_t>(array->GetNumberOfCells()) : 0;
    if (count == 0)
        throw InvalidInput({path.string(), std::string("holds no ") + shape, "", "check how it was made"});
    if (!array->IsValid())
        throw InvalidInput({path.string(), "its cell offsets are inconsistent", "", "write it again"});
    std::vector<std::array<std::int32_t, Corners>> cells(count);
    for (std::size_t i = 0; i < count; ++i) {
        vtkIdType corners = 0;
        const vtkIdType* nodes = nullptr;
        array->GetCellAtId(static_cast<vtkIdType>(i), corners, nodes);
        const std::string culprit = path.string() + ": cell " + std::to_string(i);
        if (corners != static_cast<vtkIdType>(Corners))
            throw InvalidInput({culprit, "has " + std::to_string(corners) + " corners",
                                std::string("a ") + shape, "triangulate it first"});
        for (std::size_t corner = 0; corner < Corners; ++corner) {
            if (nodes[corner] < 0 || static_cast<std::size_t>(nodes[corner]) >= points)
                throw InvalidInput({culprit, "names point " + std::to_string(nodes[corner]),
                                    "0 ... " + std::to_string(points) + " - 1", "write it again"});
            cells[i][corner] = static_cast<std::int32_t>(nodes[corner]);
        }
    }
    return cells;
}

void add_field(vtkDataObject* data, vtkAbstractArray* array, const char* name) {
    array->SetName(name);
    data->GetFieldData()->AddArray(array);
}

void add_space(vtkDataObject* data) {
    vtkNew<vtkStringArray> space;
    space->InsertNextValue("LPS");
    add_field(data, space, "SPACE");
}

void require_lps(vtkDataObject* data, const fs::path& path) {
    if (const std::string space = space_of(data); !space.empty() && space != "LPS")
        throw InvalidInput({path.string(), "its SPACE is " + space, "LPS",
                            "export it as LPS, the default of 3D Slicer since 2020"});
}

void add_labels(vtkDataObject* data, const std::vector<Label>& labels, const std::string& prefix) {
    vtkNew<vtkStringArray> names;
    vtkNew<vtkTypeInt32Array> values;
    vtkNew<vtkFloatArray> colours;
    colours->SetNumberOfComponents(3);
    for (const Label& label : labels) {
        names->InsertNextValue(label.name);
        values->InsertNextValue(label.value);
        colours->InsertNextTypedTuple(label.colour.data());
    }
    add_field(data, names, (prefix + "_names").c_str());
    add_field(data, values, (prefix + "_values").c_str());
    add_field(data, colours, (prefix + "_colours").c_str());
}

vtkNew<vtkTypeInt32Array> make_integers(const std::vector<std::int32_t>& values, const char* name) {
    vtkNew<vtkTypeInt32Array> array;
    array->SetName(name);
    array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
    std::ranges::copy(values, array->GetPointer(0));
    return array;
}

}  // namespace

TriangleMesh read_surface(const fs::path& path) {
    vtkNew<XmlSurfaceReader> reader;
    read_with(*reader.Get(), path, "VTK PolyData file (.vtp)");
    vtkPolyData* data = reader->GetOutput();
    require_lps(data, path);
    if (data->GetNumberOfStrips() > 0)
        throw InvalidInput({path.string(), "holds triangle strips", "triangles", "triangulate it first"});
    TriangleMesh surface;
    surface.vertices = read_points(data->GetPoints(), path);
    surface.triangles = read_cells<3>(data->GetPolys(), surface.vertices.size(), "triangle", path);
    return surface;
}

void write_surface(const fs::path& path, const TriangleMesh& surface) {
    vtkNew<vtkPolyData> data;
    data->SetPoints(make_points(surface.vertices));
    data->SetPolys(make_cells(surface.triangles));
    add_space(data);
    vtkNew<vtkXMLPolyDataWriter> writer;
    write_file(writer.Get(), data, path);
}

TetMesh read_tetrahedra(const fs::path& path) {
    vtkNew<XmlGridReader> reader;
    read_with(*reader.Get(), path, "VTK UnstructuredGrid file (.vtu)");
    vtkUnstructuredGrid* data = reader->GetOutput();
    require_lps(data, path);
    TetMesh mesh;
    mesh.rest_positions = read_points(data->GetPoints(), path);
    for (vtkIdType cell = 0; cell < data->GetNumberOfCells(); ++cell)
        if (data->GetCellType(cell) != VTK_TETRA)
            throw InvalidInput({path.string(), "cell " + std::to_string(cell) + " is no linear tetrahedron",
                                "VTK cell type 10", "keep only its tetrahedra"});
    mesh.tetrahedra = read_cells<4>(data->GetCells(), mesh.rest_positions.size(), "tetrahedron", path);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (!(six_volume(mesh, t) > 0))
            throw InvalidInput({path.string(),
                                "tetrahedron " + std::to_string(t) + " has volume " +
                                    std::to_string(six_volume(mesh, t) / 6) + " mm³",
                                "a positive volume", "mesh again, or swap two of its nodes"});

    const auto regions = read_integers(data->GetCellData(), "region", mesh.tetrahedra.size(), path);
    mesh.regions = regions.value_or(std::vector<std::int32_t>(mesh.tetrahedra.size(), 1));
    if (std::ranges::min(mesh.regions) < 1)
        throw InvalidInput({path.string(),
                            "a tetrahedron is in region " + std::to_string(std::ranges::min(mesh.regions)),
                            "1 or more", "remove or relabel it"});
    mesh.region_names = occurring_labels(mesh.regions, read_labels(data, "region"));
    mesh.outside_labels =
        read_integers(data->GetPointData(), "outside_label", mesh.rest_positions.size(), path)
            .value_or(std::vector<std::int32_t>{});
    mesh.outside_names = occurring_labels(mesh.outside_labels, read_labels(data, "outside"));
    return mesh;
}

void write_tetrahedra(const fs::path& path, const TetMesh& mesh) {
    vtkNew<vtkUnstructuredGrid> data;
    data->SetPoints(make_points(mesh.rest_positions));
    data->SetCells(VTK_TETRA, make_cells(mesh.tetrahedra));
    data->GetCellData()->AddArray(make_integers(mesh.regions, "region"));
    if (!mesh.outside_labels.empty())
        data->GetPointData()->AddArray(make_integers(mesh.outside_labels, "outside_label"));
    add_labels(data, mesh.region_names, "region");
    add_labels(data, mesh.outside_names, "outside");
    add_space(data);
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    write_file(writer.Get(), data, path);
}

}  // namespace palpate::meshing
