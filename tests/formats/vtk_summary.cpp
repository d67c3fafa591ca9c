// SPDX-License-Identifier: Apache-2.0
// vtk_summary ASSET.vtkhdf: what VTK's own reader finds in an asset, as JSON.
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkHDFReader.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

int main(int, char** argv) {
    vtkNew<vtkHDFReader> reader;
    reader->SetFileName(argv[1]);
    reader->Update();
    auto* grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutputDataObject(0));
    vtkDataArray* region = grid == nullptr ? nullptr : grid->GetCellData()->GetArray("region");
    if (region == nullptr) return 1;
    std::map<std::string, int> tetrahedra_of_region, cells_of_type;
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
        ++cells_of_type[std::to_string(grid->GetCellType(cell))];
        if (grid->GetCellType(cell) == 10)
            ++tetrahedra_of_region[std::to_string(static_cast<int>(region->GetTuple1(cell)))];
    }
    std::cout << nlohmann::json{{"points", grid->GetNumberOfPoints()},
                                {"cells_of_type", cells_of_type},
                                {"tetrahedra_of_region", tetrahedra_of_region}}
              << '\n';
}
