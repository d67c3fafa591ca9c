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

  private:
    bool fits(vtkXMLDataElement& array, double room, std::uintmax_t file_size);
    std::optional<std::vector<std::uint64_t>> read_words(std::size_t count);
};

/// Whether VTK knows the type of every array below an element; its readers of XML crash at others.
bool knows_types(vtkXMLDataElement& element);

/// One of VTK's readers of XML, which complains of compressed data beyond what set_room() says instead of
/// allocating them, and of arrays of types that VTK does not know.
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
        auto* const parser = BlocksChecked::SafeDownCast(this->XMLParser);
        if (file->GetAttribute("compressor") == nullptr ||
            (parser != nullptr && parser->fit(*file, room_, std::filesystem::file_size(this->GetFileName()))))
            return Reader::ReadVTKFile(file);
        vtkErrorWithObjectMacro(this, "blocks of data beyond what the file has room for");
        return 0;
    }

    double room() const { return room_; }

  private:
    double room_ = 0;
};

}  // namespace palpate::vtk_blocks
