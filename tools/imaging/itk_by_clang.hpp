// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Debian's ITK was configured by GCC, and this file of it refuses any other compiler, though the rest does
// not: here Clang answers it as the GCC whose standard library it uses.
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
