// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdexcept>
#include <string>

namespace palpate {

/// What went wrong, in the parts a message is made of. Empty parts are left out.
struct ErrorDetail {
    std::string culprit;    ///< the file, option or field at fault, e.g. "liver.nrrd"
    std::string found;      ///< e.g. "label 3 \"tumour\" has 2 components of 40 mm³ or more"
    std::string expected;   ///< e.g. "1"
    std::string next_step;  ///< e.g. "keep the largest with 'palpate segment --keep-largest tumour'"
};

/// Formats "culprit: found (expected ...); next step".
std::string to_string(const ErrorDetail& detail);

/// Base of every error that reaches a user; its message is to_string(detail).
class Error : public std::runtime_error {
  public:
    explicit Error(ErrorDetail detail);
    const ErrorDetail& detail() const noexcept { return detail_; }

  private:
    ErrorDetail detail_;
};

/// A file, value or combination of inputs that cannot be used (exit code 3).
class InvalidInput : public Error {
  public:
    using Error::Error;
};

/// Arguments that make no sense together (exit code 2).
class UsageError : public Error {
  public:
    using Error::Error;
};

/// A result below the case's quality contract (exit code 4).
class QualityNotMet : public Error {
  public:
    using Error::Error;
};

/// Something outside the input failed: disk full, no permission, no display (exit code 1).
class SystemFailure : public Error {
  public:
    using Error::Error;
};

}  // namespace palpate
