// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/vtk_blocks/checked_blocks.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <istream>
#include <span>
#include <string_view>
#include <vtkInputStream.h>
#include <vtkNew.h>

namespace palpate::vtk_blocks {
namespace {

bool is_array_of_texts(vtkXMLDataElement& element) {
    const char* const type = element.GetAttribute("type");
    return type != nullptr && std::strcmp(type, "String") == 0;
}

bool knows_type(vtkXMLDataElement& array) {
    constexpr std::array<std::string_view, 12> types{"Int8",    "UInt8",   "Int16",  "UInt16",
                                                     "Int32",   "UInt32",  "Int64",  "UInt64",
                                                     "Float32", "Float64", "String", "Bit"};
    const char* const type = array.GetAttribute("type");
    return type != nullptr && std::ranges::find(types, std::string_view(type)) != types.end();
}

}  // namespace

vtkStandardNewMacro(BlocksChecked);

bool knows_types(vtkXMLDataElement& element) {
    const std::string_view name = element.GetName();
    for (int n = 0; n < element.GetNumberOfNestedElements(); ++n) {
        vtkXMLDataElement& nested = *element.GetNestedElement(n);
        const std::string_view its_name = nested.GetName();
        // All that is in a FieldData is taken for arrays, whatever it is called.
        const bool array = name == "FieldData" || its_name == "DataArray" || its_name == "Array";
        if ((array && !knows_type(nested)) || !knows_types(nested)) return false;
    }
    return true;
}

void drop_texts(vtkXMLDataElement& element) {
    const bool field = std::strcmp(element.GetName(), "FieldData") == 0;
    for (int n = element.GetNumberOfNestedElements() - 1; n >= 0; --n) {
        vtkXMLDataElement& nested = *element.GetNestedElement(n);
        if (!field && is_array_of_texts(nested))
            element.RemoveNestedElement(&nested);
        else
            drop_texts(nested);
    }
}

void complete_pieces(vtkXMLDataElement& element) {
    if (std::strcmp(element.GetName(), "Piece") == 0 &&
        element.FindNestedElementWithName("PointData") == nullptr) {
        const vtkNew<vtkXMLDataElement> none;
        none->SetName("PointData");
        element.AddNestedElement(none);
    }
    for (int n = 0; n < element.GetNumberOfNestedElements(); ++n)
        complete_pieces(*element.GetNestedElement(n));
}

bool BlocksChecked::texts_fit(vtkXMLDataElement& element, double room) {
    if (is_array_of_texts(element) && !has_no_more_texts_than_announced(element, room)) return false;
    for (int n = 0; n < element.GetNumberOfNestedElements(); ++n)
        if (!texts_fit(*element.GetNestedElement(n), room)) return false;
    return true;
}

// A text ends with a zero.
bool BlocksChecked::has_no_more_texts_than_announced(vtkXMLDataElement& array, double room) {
    int tuples = 0, components = 1;
    array.GetScalarAttribute("NumberOfTuples", tuples);
    array.GetScalarAttribute("NumberOfComponents", components);
    const double announced = static_cast<double>(tuples) * components;
    vtkTypeInt64 offset = 0;  // as VTK takes one that is no number
    const bool appended = array.GetAttribute("offset") != nullptr;
    array.GetScalarAttribute("offset", offset);
    const char* const format = array.GetAttribute("format");
    const bool ascii = format == nullptr || std::strcmp(format, "binary") != 0;
    std::array<char, 4096> letters;
    const auto read_from = [&](vtkTypeUInt64 at, std::size_t count) {
        Stream->clear();
        return appended ? ReadAppendedData(offset, letters.data(), at, count, VTK_CHAR)
                        : ReadInlineData(&array, ascii ? 1 : 0, letters.data(), at, count, VTK_CHAR);
    };
    double ends = 0;
    for (vtkTypeUInt64 at = 0; static_cast<double>(at) <= room;) {
        // Where a later block is damaged, fewer letters may be read, as VTK may do.
        std::size_t read = 0;
        for (std::size_t count = letters.size(); read == 0 && count > 0; count /= 2)
            read = read_from(at, count);
        if (read == 0) return true;
        ends += static_cast<double>(std::ranges::count(std::span(letters).first(read), '\0'));
        if (ends > announced) return false;
        at += read;
    }
    return false;
}

bool BlocksChecked::fit(vtkXMLDataElement& element, double room, std::uintmax_t file_size) {
    const char* const format = element.GetAttribute("format");
    const bool data = element.GetAttribute("offset") != nullptr ||
                      (format != nullptr && std::strcmp(format, "binary") == 0);
    if (data && !fits(element, room, file_size)) return false;
    for (int n = 0; n < element.GetNumberOfNestedElements(); ++n)
        if (!fit(*element.GetNestedElement(n), room, file_size)) return false;
    return true;
}

bool BlocksChecked::fits(vtkXMLDataElement& array, double room, std::uintmax_t file_size) {
    Stream->clear();  // or nothing is read any more once an array before reached the file's end
    if (array.GetAttribute("offset") != nullptr) {
        vtkTypeInt64 offset = 0;
        if (array.GetScalarAttribute("offset", offset) == 0) return false;  // which VTK takes for 0
        if (AppendedDataPosition == 0 || offset < 0) return false;
        DataStream = AppendedDataStream;
        SeekG(AppendedDataPosition + offset);
    } else {
        DataStream = InlineDataStream;
        SeekInlineDataPosition(&array);
    }
    DataStream->SetStream(Stream);
    DataStream->StartReading();
    const auto begin = read_words(3);
    if (!begin) return true;  // which VTK says itself where it wants the data
    const auto blocks = (*begin)[0], size = (*begin)[1], last = (*begin)[2];
    if (blocks == 0) return last == 0;  // which would count one less than none
    const double whole = static_cast<double>(blocks) - (last > 0 ? 1 : 0);
    if (blocks > file_size / 4 || size == 0 || last > size ||
        !(whole * static_cast<double>(size) + static_cast<double>(last) <= room))
        return false;
    const auto packed = read_words(blocks);
    DataStream->EndReading();
    return packed && std::ranges::all_of(*packed, [&](std::uint64_t bytes) { return bytes <= file_size; });
}

// Nothing if there are fewer.
std::optional<std::vector<std::uint64_t>> BlocksChecked::read_words(std::size_t count) {
    const std::size_t width = HeaderType == 64 ? 8 : 4;
    std::vector<unsigned char> bytes(count * width);
    if (DataStream->Read(bytes.data(), bytes.size()) < bytes.size()) return std::nullopt;
    std::vector<std::uint64_t> words(count);
    for (std::size_t n = 0; n < count; ++n)
        for (std::size_t b = 0; b < width; ++b)
            words[n] = words[n] << 8U | bytes[n * width + (ByteOrder == BigEndian ? b : width - 1 - b)];
    return words;
}

}  // namespace palpate::vtk_blocks
