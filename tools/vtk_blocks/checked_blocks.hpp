// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>
#include <vtkCommand.h>
#include <vtkObjectFactory.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>

namespace palpate::vtk_blocks {

/// VTK's parser allocates the blocks that the header of compressed data announces (number of blocks, size of
/// a block, size of the last one if it is smaller, packed size of each), divides by their size and goes where
/// their number leads. This one can look at them first.
class BlocksChecked : public vtkXMLDataParser {
  public:
    static BlocksChecked* New();
    vtkTypeMacro(BlocksChecked, vtkXMLDataParser);

    /// Whether all data below an element fit into `room` bytes, and packed into those of the file.
    bool fit(vtkXMLDataElement& element, double room, std::uintmax_t file_size);

    /// Whether no array of texts in a FieldData below an element has more texts than it announces, of some
    /// `room` bytes: VTK writes all that it meets into the array. Once the reader knows how data are packed.
    bool texts_fit(vtkXMLDataElement& element, double room);

  private:
    bool has_no_more_texts_than_announced(vtkXMLDataElement& array, double room);
    bool fits(vtkXMLDataElement& array, double room, std::uintmax_t file_size);
    std::optional<std::vector<std::uint64_t>> read_words(std::size_t count);
};

/// Whether VTK knows the type of every array below an element; its readers of XML crash at others.
bool knows_types(vtkXMLDataElement& element);

/// Takes arrays of texts but those of a FieldData out of what is below an element: nothing here reads them,
/// and VTK would write more of them than there are points or cells.
void drop_texts(vtkXMLDataElement& element);

/// Gives every piece below an element its PointData: without, VTK crashes over an array of cells that is too
/// short.
void complete_pieces(vtkXMLDataElement& element);

/// One of VTK's readers of XML, which complains of compressed data beyond what set_room() says instead of
/// allocating them, of arrays of types that VTK does not know, and of more texts than there is room for.
template <typename Reader>
class WithCheckedBlocks : public Reader {
  public:
    // NOLINTNEXTLINE(readability-identifier-naming): VTK's
    static WithCheckedBlocks* New() { VTK_STANDARD_NEW_BODY(WithCheckedBlocks); }
    void set_room(std::size_t bytes) { room_ = static_cast<double>(bytes); }

  protected:
    void CreateXMLParser() override {
        if (this->XMLParser != nullptr) this->DestroyXMLParser();
        this->XMLParser = BlocksChecked::New();
        if (vtkCommand* const observer = this->GetParserErrorObserver(); observer != nullptr)
            this->XMLParser->AddObserver(vtkCommand::ErrorEvent, observer);
    }

    int ReadVTKFile(vtkXMLDataElement* file) override {
        if (!knows_types(*file)) {
            vtkErrorWithObjectMacro(this, "an array of a type that VTK does not know");
            return 0;
        }
        drop_texts(*file);
        complete_pieces(*file);
        auto& parser = *BlocksChecked::SafeDownCast(this->XMLParser);
        if (file->GetAttribute("compressor") != nullptr &&
            !parser.fit(*file, room_, std::filesystem::file_size(this->GetFileName()))) {
            vtkErrorWithObjectMacro(this, "blocks of data beyond what the file has room for");
            return 0;
        }
        if (Reader::ReadVTKFile(file) == 0) return 0;
        if (parser.texts_fit(*file, room_)) return 1;
        vtkErrorWithObjectMacro(this, "more texts than an array has tuples");
        return 0;
    }

    double room() const { return room_; }

  private:
    double room_ = 0;
};

}  // namespace palpate::vtk_blocks
