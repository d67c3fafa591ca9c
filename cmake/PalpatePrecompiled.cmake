# SPDX-License-Identifier: Apache-2.0
# Headers that many files include and that are dear to read, compiled once a set.
set(palpate_standard_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
    <numeric> <optional> <random> <set> <span> <sstream> <string> <string_view> <utility> <vector>)

palpate_precompiled(values LINKS Eigen3::Eigen HEADERS ${palpate_standard_headers} <Eigen/Dense>)
# What hands data on, where a third of the time to compile went into making it fast.
palpate_precompiled(commands OPTIONS $<$<CONFIG:Release>:-O1> LINKS Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json
    HEADERS ${palpate_standard_headers} <Eigen/Dense> <fmt/format.h> <nlohmann/json.hpp>)
if(PALPATE_TESTS)
    # What tests do themselves is not looked at for undefined behaviour, with ONCE not for wrong addresses either: more than
    # half of the time to compile them. What formats and runtime do is, and what lies on the heap.
    if(PALPATE_SANITIZERS MATCHES "undefined")
        set(palpate_unlooked -fno-sanitize=$<$<STREQUAL:${PALPATE_TESTS},ONCE>:address,>undefined)
    endif()
    palpate_precompiled(tests OPTIONS $<$<CONFIG:Release>:-O1> ${palpate_unlooked} LINKS Eigen3::Eigen GTest::gtest
        HEADERS ${palpate_standard_headers} <Eigen/Dense> <gmock/gmock.h> <gtest/gtest.h>)
endif()
