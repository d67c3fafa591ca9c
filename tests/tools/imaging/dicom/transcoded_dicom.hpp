// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gdcmTransferSyntax.h>
#include <string>

namespace palpate::test {

/// The bytes of a DICOM file in another transfer syntax, by GDCM. Throws std::runtime_error where it cannot.
std::string transcoded(const std::string& file, gdcm::TransferSyntax::TSType syntax);

}  // namespace palpate::test
