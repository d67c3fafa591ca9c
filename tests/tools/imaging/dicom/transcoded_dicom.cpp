// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/imaging/dicom/transcoded_dicom.hpp"

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <stdexcept>

#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"

namespace palpate::test {

std::string transcoded(const std::string& file, gdcm::TransferSyntax::TSType syntax) {
    const sample::Scratch folder;
    const std::string from = folder / "from", to = folder / "to";
    write_bytes(from, file);
    gdcm::ImageReader reader;
    reader.SetFileName(from.c_str());
    if (!reader.Read()) throw std::runtime_error("GDCM cannot read the file");
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntax);
    change.SetInput(reader.GetImage());
    if (!change.Change()) throw std::runtime_error("GDCM cannot change the transfer syntax");
    gdcm::ImageWriter writer;
    writer.SetFileName(to.c_str());
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    if (!writer.Write()) throw std::runtime_error("GDCM cannot write the file");
    return bytes_of(to);
}

}  // namespace palpate::test
