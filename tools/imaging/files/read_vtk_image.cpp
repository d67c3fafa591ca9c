// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <vtkDataArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>
#include <vtkXMLImageDataReader.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/read_image.hpp"
#include "tools/vtk_blocks/checked_blocks.hpp"

namespace palpate::imaging {
namespace {

// VTK's readers print what is wrong with a file and carry on; this remembers that they did.
class Complaints : public vtkOutputWindow {
  public:
    static Complaints* New();
    void DisplayText(const char*) override { any = true; }
    bool any = false;
};
vtkStandardNewMacro(Complaints);

// VTK would allocate whatever a header claims; a voxel takes a byte or more where nothing is compressed.
void check_extent(const std::array<int, 6>& extent, const std::filesystem::path& path) {
    std::array<std::int64_t, 3> size{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        size[axis] = std::int64_t{extent[2 * axis + 1]} - extent[2 * axis] + 1;
    check_size(size, path);
    std::string head(4096, '\0');
    std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
    const bool packed = head.find("compressor=") != std::string::npos;
    check_claim(static_cast<std::uintmax_t>(size[0] * size[1] * size[2]), std::filesystem::file_size(path),
                packed ? Packing::deflated : Packing::none, path);
}

template <typename Reader>
vtkSmartPointer<vtkImageData> output_of(Reader& reader, const std::filesystem::path& path) {
    const vtkSmartPointer<vtkOutputWindow> usual = vtkOutputWindow::GetInstance();
    vtkNew<Complaints> complaints;
    vtkOutputWindow::SetInstance(complaints);
    const std::unique_ptr<vtkOutputWindow, void (*)(vtkOutputWindow*)> restore(usual,
                                                                               vtkOutputWindow::SetInstance);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    vtkObject::GlobalWarningDisplayOn();
    reader.SetFileName(path.c_str());
    reader.UpdateInformation();
    std::array<int, 6> extent{};
    reader.GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
    if (!complaints->any) {
        check_extent(extent, path);
        reader.Update();
    }
    if (complaints->any || reader.GetErrorCode() != vtkErrorCode::NoError || reader.GetOutput() == nullptr)
        throw InvalidInput(
            {path.string(), "cannot be read as VTK image data", "", "check that the file is whole"});
    return reader.GetOutput();
}

vtkSmartPointer<vtkImageData> load(const std::filesystem::path& path) {
    vtkNew<vtk_blocks::WithCheckedBlocks<vtkXMLImageDataReader>> reader;
    reader->set_room(std::filesystem::file_size(path) * static_cast<std::uintmax_t>(Packing::deflated));
    if (reader->CanReadFile(path.c_str()) == 0)
        throw InvalidInput({path.string(), "is not VTK XML image data", "", "check that the file is whole"});
    return output_of(*reader, path);
}

template <typename Voxel>
std::vector<Voxel> copy(vtkDataArray& array) {
    const auto* first = static_cast<const Voxel*>(array.GetVoidPointer(0));
    return {first, first + array.GetNumberOfValues()};
}

StoredVoxels voxels_of(vtkDataArray& array, const std::filesystem::path& path) {
    switch (array.GetDataType()) {
        case VTK_UNSIGNED_CHAR:
            return copy<std::uint8_t>(array);
        case VTK_CHAR:
        case VTK_SIGNED_CHAR:
            return copy<std::int8_t>(array);
        case VTK_UNSIGNED_SHORT:
            return copy<std::uint16_t>(array);
        case VTK_SHORT:
            return copy<std::int16_t>(array);
        case VTK_UNSIGNED_INT:
            return copy<std::uint32_t>(array);
        case VTK_INT:
            return copy<std::int32_t>(array);
        case VTK_UNSIGNED_LONG:
        case VTK_UNSIGNED_LONG_LONG:
            return copy<std::uint64_t>(array);
        case VTK_LONG:
        case VTK_LONG_LONG:
        case VTK_ID_TYPE:
            return copy<std::int64_t>(array);
        case VTK_FLOAT:
            return copy<float>(array);
        case VTK_DOUBLE:
            return copy<double>(array);
        default:
            throw InvalidInput({path.string(), std::string("holds ") + array.GetDataTypeAsString(),
                                "integers or real numbers", "export it as short or float"});
    }
}

// Meshes and images of 3D Slicer say their frame in a field SPACE; others say nothing.
bool is_ras(vtkImageData& data, const std::filesystem::path& path, const NoteSink& note) {
    auto* space = vtkStringArray::SafeDownCast(data.GetFieldData()->GetAbstractArray("SPACE"));
    if (space != nullptr && space->GetNumberOfValues() == 1) {
        const std::string name = space->GetValue(0);
        if (name != "LPS" && name != "RAS")
            throw InvalidInput({path.string(), "has the SPACE '" + as_utf8(name).substr(0, 40) + "'",
                                "LPS or RAS", "export it in one of these"});
        return name == "RAS";
    }
    if (note) note("the header names no patient space; taken as LPS");
    return false;
}

}  // namespace

StoredImage read_vtk_image(const std::filesystem::path& path, const NoteSink& note) {
    const vtkSmartPointer<vtkImageData> data = load(path);
    vtkDataArray* scalars = data->GetPointData()->GetScalars();
    if (scalars == nullptr) scalars = data->GetPointData()->GetArray(0);
    if (scalars == nullptr || scalars->GetNumberOfComponents() != 1 ||
        data->GetPointData()->GetNumberOfArrays() > 1)
        throw InvalidInput(
            {path.string(),
             fmt::format("has {} arrays at its points", data->GetPointData()->GetNumberOfArrays()),
             "one array of scalars", "export one scalar volume with values at points"});
    StoredImage image;
    Eigen::Matrix3d axes;
    Eigen::Vector3d first;
    for (int axis = 0; axis < 3; ++axis) {
        const auto* extent = data->GetExtent();
        image.grid.size[axis] = data->GetDimensions()[axis];
        first[axis] = extent[std::ptrdiff_t{2} * axis];
        image.grid.origin[axis] = data->GetOrigin()[axis];
        for (int row = 0; row < 3; ++row)
            axes(row, axis) = data->GetDirectionMatrix()->GetElement(row, axis) * data->GetSpacing()[axis];
    }
    image.grid.origin += axes * first;
    if (is_ras(*data, path, note)) {
        axes.topRows<2>() *= -1;
        image.grid.origin.head<2>() *= -1;
    }
    set_axes(image.grid, axes);
    check_geometry(image.grid, path, note);
    image.voxels = voxels_of(*scalars, path);
    if (std::visit([](const auto& v) { return v.size(); }, image.voxels) != image.grid.voxel_count())
        throw InvalidInput(
            {path.string(), "holds fewer voxels than its header claims", "", "check that the file is whole"});
    return image;
}

}  // namespace palpate::imaging
