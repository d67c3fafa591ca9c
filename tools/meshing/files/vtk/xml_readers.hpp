// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkObjectFactory.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

namespace palpate::meshing {

/// VTK's parser allocates the blocks that the header of compressed data announces (number of blocks, size of
/// a block, size of the last one if it is smaller, packed size of each), divides by their size and goes where
/// their number leads. This one can look at them first.
class BlocksChecked : public vtkXMLDataParser {
  public:
    static BlocksChecked* New();
    vtkTypeMacro(BlocksChecked, vtkXMLDataParser);

    /// Whether all data below an element fit into `room` bytes, and packed into those of the file.
    bool fit(vtkXMLDataElement& element, double room, std::uintmax_t file_size);

  private:
    bool fits(vtkXMLDataElement& array, double room, std::uintmax_t file_size);
    std::optional<std::vector<std::uint64_t>> read_words(std::size_t count);
};

/// VTK's readers of XML allocate the corners that the last offset of their cells announces, and go where
/// offsets lead. This one looks at the offsets first, and complains where they are negative or beyond what
/// set_room() says; and at the blocks of compressed data.
template <typename Reader>
class OffsetsChecked : public Reader {
  public:
    // NOLINTNEXTLINE(readability-identifier-naming): VTK's
    static OffsetsChecked* New() { VTK_STANDARD_NEW_BODY(OffsetsChecked); }
    void set_room(std::size_t values) { room_ = static_cast<double>(values); }

  protected:
    void CreateXMLParser() override {
        if (this->XMLParser != nullptr) this->DestroyXMLParser();
        this->XMLParser = BlocksChecked::New();
        if (vtkCommand* const observer = this->GetParserErrorObserver(); observer != nullptr)
            this->XMLParser->AddObserver(vtkCommand::ErrorEvent, observer);
    }

    int ReadVTKFile(vtkXMLDataElement* file) override {
        auto* const parser = BlocksChecked::SafeDownCast(this->XMLParser);
        if (file->GetAttribute("compressor") == nullptr ||
            (parser != nullptr && parser->fit(*file, room_, std::filesystem::file_size(this->GetFileName()))))
            return Reader::ReadVTKFile(file);
        vtkErrorWithObjectMacro(this, "blocks of data beyond what the file has room for");
        return 0;
    }

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
            if (const double offset = offsets->GetComponent(i, 0); !(offset >= 0 && offset <= room_))
                return false;
        return true;
    }

    double room_ = 0;
};

using XmlGridReader = OffsetsChecked<vtkXMLUnstructuredGridReader>;
using XmlSurfaceReader = OffsetsChecked<vtkXMLPolyDataReader>;

}  // namespace palpate::meshing
