// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <concepts>
#include <vtkDataArray.h>
#include <vtkObjectFactory.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "tools/vtk_blocks/checked_blocks.hpp"

namespace palpate::meshing {

/// VTK's readers of XML allocate the corners that the last offset of their cells announces, and go where
/// offsets lead. This one looks at the offsets first, and complains where they are negative or beyond what
/// set_room() says; and at the blocks of compressed data.
template <typename Reader>
class OffsetsChecked : public vtk_blocks::WithCheckedBlocks<Reader> {
  public:
    // NOLINTNEXTLINE(readability-identifier-naming): VTK's
    static OffsetsChecked* New() { VTK_STANDARD_NEW_BODY(OffsetsChecked); }

  protected:
    int ReadPieceData() override {
        const int piece = this->Piece;
        bool fit = false;
        if constexpr (std::same_as<Reader, vtkXMLPolyDataReader>)
            fit = fits(this->VertElements[piece], this->NumberOfVerts[piece]) &&
                  fits(this->LineElements[piece], this->NumberOfLines[piece]) &&
                  fits(this->StripElements[piece], this->NumberOfStrips[piece]) &&
                  fits(this->PolyElements[piece], this->NumberOfPolys[piece]);
        else
            fit = fits(this->CellElements[piece], this->NumberOfCells[piece]);
        if (fit) return Reader::ReadPieceData();
        vtkErrorWithObjectMacro(this, "offsets of cells beyond what the file has room for");
        return 0;
    }

  private:
    bool fits(vtkXMLDataElement* cells, vtkIdType count) {
        if (cells == nullptr || count < 1) return true;
        vtkXMLDataElement* const element = this->FindDataArrayWithName(cells, "offsets");
        if (element == nullptr) return true;  // which VTK says itself
        const auto array = vtkSmartPointer<vtkAbstractArray>::Take(this->CreateArray(element));
        auto* const offsets = vtkDataArray::SafeDownCast(array);
        if (offsets == nullptr) return false;
        offsets->SetNumberOfComponents(1);
        offsets->SetNumberOfTuples(count);
        if (this->ReadArrayValues(element, 0, offsets, 0, count) == 0) return false;
        for (vtkIdType i = 0; i < count; ++i)
            if (const double offset = offsets->GetComponent(i, 0); !(offset >= 0 && offset <= this->room()))
                return false;
        return true;
    }
};

using XmlGridReader = OffsetsChecked<vtkXMLUnstructuredGridReader>;
using XmlSurfaceReader = OffsetsChecked<vtkXMLPolyDataReader>;

}  // namespace palpate::meshing
