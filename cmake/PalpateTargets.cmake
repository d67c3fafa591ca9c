# SPDX-License-Identifier: Apache-2.0
# One target per folder: palpate_library(), palpate_executable(), palpate_test(), all with the house's warnings.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
endif()

find_program(PALPATE_CCACHE ccache)
if(PALPATE_CCACHE)
    # Precompiled headers need the sloppiness named in ccache's manual, "Precompiled headers".
    set(palpate_launcher ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${PALPATE_CCACHE})
    set(CMAKE_C_COMPILER_LAUNCHER ${palpate_launcher})
    set(CMAKE_CXX_COMPILER_LAUNCHER ${palpate_launcher})
endif()

# What every target of ours is compiled with; never exported. Presets make warnings errors.
add_library(palpate_house INTERFACE)
target_compile_options(palpate_house INTERFACE -Wall -Wextra -Wconversion -fno-math-errno)
# Libraries and programs alike: a precompiled header serves only one kind of code.
target_compile_options(palpate_house INTERFACE -fPIC)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 is wrong about std::string (-Wrestrict, GCC bug 105651) and about Eigen views by std::vector
    # (-Wfree-nonheap-object).
    target_compile_options(palpate_house INTERFACE -Wno-restrict -Wno-free-nonheap-object)
    # Its garbage collector waits for a gigabyte: some 7 % of the time to compile.
    target_compile_options(palpate_house INTERFACE "SHELL:--param ggc-min-heapsize=1048576"
                                                   "SHELL:--param ggc-min-expand=100")
    # Lets ccache see which precompiled header a file was compiled with.
    target_compile_options(palpate_house INTERFACE -fpch-preprocess)
    if(CMAKE_UNITY_BUILD)
        # Where files are compiled together it also inlines std::string and std::vector until it sees overflows that
        # are none, and takes a .cpp's own types for a header's. Preset dev keeps most of these warnings.
        target_compile_options(palpate_house INTERFACE -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds
                                                       -Wno-subobject-linkage)
    else()
        # The same in single files, about std::string's own buffer.
        target_compile_options(palpate_house INTERFACE -Wno-array-bounds)
    endif()
else()
    # Clang counts the sign of an index to -Wconversion, GCC does not.
    target_compile_options(palpate_house INTERFACE -Wno-sign-conversion)
    # A precompiled header's own time would make every build a new one for ccache.
    target_compile_options(palpate_house INTERFACE "SHELL:-Xclang -fno-pch-timestamp")
endif()
if(PALPATE_ASSERTIONS)
    # The standard library's too: an index out of range, or below zero, ends the program there.
    target_compile_options(palpate_house INTERFACE -UNDEBUG -D_GLIBCXX_ASSERTIONS)
endif()
# Of the folder that asks for it and those below: with PALPATE_COVERAGE it is counted which lines run.
macro(palpate_count_lines)
    if(PALPATE_COVERAGE)
        add_compile_options(-fprofile-instr-generate -fcoverage-mapping)
    endif()
endmacro()
if(PALPATE_COVERAGE)
    add_link_options($<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-fprofile-instr-generate>)
endif()
if(PALPATE_SANITIZERS)
    add_compile_options(-fsanitize=${PALPATE_SANITIZERS} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    add_link_options(-fsanitize=${PALPATE_SANITIZERS})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND PALPATE_SANITIZERS MATCHES "undefined")
        # A driver's functions are called by declarations of our own, whose structures have other names than its.
        add_compile_options(-fno-sanitize=function)
    endif()
    if(PALPATE_UNSANITIZED)
        add_compile_options(-fno-sanitize=${PALPATE_UNSANITIZED})
    endif()
    # Tests that count allocations ask the sanitizer instead of malloc.
    add_compile_definitions(PALPATE_SANITIZED)
endif()

# palpate_precompiled(<set> [OPTIONS ...] LINKS ... HEADERS ...): headers that are compiled once; a target takes a set with
# PRECOMPILED <set>. Every file still includes what it uses: preset tidy reads it without them. OPTIONS: of the compiler, for
# the set and all who take it, since a precompiled header serves only what is compiled as it was.
function(palpate_precompiled set)
    cmake_parse_arguments(arg "" "" "OPTIONS;LINKS;HEADERS" ${ARGN})
    add_library(palpate_precompiled_${set} OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
    set_target_properties(palpate_precompiled_${set} PROPERTIES PALPATE_OPTIONS "${arg_OPTIONS}")
    target_compile_options(palpate_precompiled_${set} PRIVATE ${arg_OPTIONS})
    target_link_libraries(palpate_precompiled_${set} PRIVATE ${arg_LINKS} palpate_house)
    target_compile_features(palpate_precompiled_${set} PUBLIC cxx_std_20)
    target_precompile_headers(palpate_precompiled_${set} PRIVATE ${arg_HEADERS})
endfunction()

function(palpate_reuse_precompiled target set)
    if(TARGET palpate_precompiled_${set})
        target_precompile_headers(${target} REUSE_FROM palpate_precompiled_${set})
        get_target_property(options palpate_precompiled_${set} PALPATE_OPTIONS)
        target_compile_options(${target} PRIVATE ${options})
    endif()
endfunction()

# Where a preset compiles several files at once: compiles the tick's (the arguments) together, apart from the target's
# others. Notes source and object of each for tests/house/tick_imports.py.
function(palpate_keep_tick_apart target)
    set(most 8)  # files a compilation: few enough that two processors share a room
    get_target_property(sources ${target} SOURCES)
    get_target_property(unity ${target} UNITY_BUILD)
    set(tick_count 0)
    set(other_count 0)
    foreach(source IN LISTS sources)
        set(kind other)
        if(source IN_LIST ARGN)
            set(kind tick)
        endif()
        math(EXPR group "${${kind}_count} / ${most}")
        math(EXPR ${kind}_count "${${kind}_count} + 1")
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${kind}${group})
        set(object ${source}.o)
        if(unity)
            set(object Unity/unity_${kind}${group}_cxx.cxx.o)
        endif()
        if(kind STREQUAL tick)
            set_property(GLOBAL APPEND PROPERTY PALPATE_TICK_OBJECTS
                "${CMAKE_CURRENT_SOURCE_DIR}/${source}\t${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/${object}")
        endif()
    endforeach()
    set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# palpate_library(<folder/name> SOURCES ... [TICK ...] [LINKS ...] [PRIVATE_LINKS ...] [PRECOMPILED set]
#                 [INSTALL HEADERS ...])
# Makes target palpate_<name> with alias Palpate::<name>. Headers are included as "<folder>/<name>/x.hpp"; those of an
# installed library are listed. TICK: the sources that run in a tick; they may import nothing that allocates, locks, throws,
# waits or does I/O.
function(palpate_library path)
    cmake_parse_arguments(arg "INSTALL" "PRECOMPILED" "SOURCES;TICK;HEADERS;LINKS;PRIVATE_LINKS" ${ARGN})
    get_filename_component(name ${path} NAME)
    set(target palpate_${name})
    add_library(${target} STATIC ${arg_SOURCES} ${arg_TICK})
    add_library(Palpate::${name} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                $<INSTALL_INTERFACE:include/palpate>)
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_link_libraries(${target} PUBLIC ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS} $<BUILD_INTERFACE:palpate_house>)
    if(NOT arg_PRECOMPILED)
        set(arg_PRECOMPILED values)
    endif()
    palpate_reuse_precompiled(${target} ${arg_PRECOMPILED})
    if(arg_TICK)
        palpate_keep_tick_apart(${target} ${arg_TICK})
    endif()
    if(arg_INSTALL)
        set_property(GLOBAL APPEND PROPERTY PALPATE_INSTALLED_LIBRARIES ${target})
        foreach(header IN LISTS arg_HEADERS)
            get_filename_component(folder ${header} DIRECTORY)
            install(FILES ${header} DESTINATION include/palpate/${path}/${folder} COMPONENT dev)
        endforeach()
    endif()
endfunction()

# palpate_executable(<name> SOURCES ... LINKS ... [PRECOMPILED set]): a command; lands in build/<preset>/bin and is installed. Target
# `commands` builds them all and nothing else.
add_custom_target(commands)
function(palpate_executable name)
    cmake_parse_arguments(arg "" "PRECOMPILED" "SOURCES;LINKS" ${ARGN})
    if(NOT arg_PRECOMPILED)
        set(arg_PRECOMPILED commands)
    endif()
    add_executable(${name} ${arg_SOURCES})
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${name} PRIVATE ${arg_LINKS} palpate_house)
    palpate_reuse_precompiled(${name} ${arg_PRECOMPILED})
    add_dependencies(commands ${name})
    install(TARGETS ${name} RUNTIME DESTINATION bin)
    set_property(GLOBAL APPEND PROPERTY PALPATE_COMMANDS_OF_${CMAKE_INSTALL_DEFAULT_COMPONENT_NAME} ${name})
endfunction()

# palpate_test(<room> SOURCES ... LINKS ... [LABEL unit|realtime|slow|...] [PRECOMPILED set] [THREADS]): GoogleTest cases,
# each a ctest named <room>.<Suite>.<case>, in the environment that PalpateDependencies.cmake sets. THREADS:
# more than one runs in it, so ThreadSanitizer has something to find; its preset has these alone, target `thread_tests`; target
# `unit_tests` is all of them. PALPATE_TESTED_SANITIZED: in this folder and those below, preset asan has them too.
add_custom_target(thread_tests)
add_custom_target(unit_tests)
function(palpate_test room)
    cmake_parse_arguments(arg "THREADS" "LABEL;TIMEOUT;PRECOMPILED" "SOURCES;LINKS" ${ARGN})
    if(NOT arg_PRECOMPILED)
        set(arg_PRECOMPILED tests)
    endif()
    if(NOT arg_LABEL)
        set(arg_LABEL unit)
    endif()
    if(NOT arg_TIMEOUT)
        set(arg_TIMEOUT 120)
    endif()
    if("thread" IN_LIST PALPATE_SANITIZERS AND NOT arg_THREADS)
        return()
    endif()
    string(REPLACE "." "_" target "test_${room}")
    if(NOT arg_LABEL STREQUAL "unit")
        set(target ${target}_${arg_LABEL})
    endif()
    if(PALPATE_TESTS STREQUAL "ONCE" AND
       (arg_LABEL STREQUAL "slow" OR (PALPATE_TESTED_SANITIZED AND NOT PALPATE_SANITIZERS)))
        set(left_out EXCLUDE_FROM_ALL)
    endif()
    add_executable(${target} ${left_out} ${arg_SOURCES})
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${target} PRIVATE ${arg_LINKS} GTest::gtest_main palpate_house)
    palpate_reuse_precompiled(${target} ${arg_PRECOMPILED})
    set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
    if(left_out)
        return()
    endif()
    add_dependencies(unit_tests ${target})
    if(arg_THREADS)
        add_dependencies(thread_tests ${target})
    endif()
    # What watches the clock runs alone; everything else may run side by side.
    if(arg_LABEL STREQUAL "realtime")
        set(alone RUN_SERIAL TRUE)
    endif()
    gtest_discover_tests(${target} TEST_PREFIX "${room}." DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
        PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${arg_TIMEOUT} ${alone})
endfunction()

# palpate_command_test(<file.py> [LABEL ...] [MAKES ...] [NEEDS ...]): a Python unittest that drives the executables in
# PALPATE_BIN. What one MAKES another NEEDS: ctest's fixtures.
function(palpate_command_test file)
    cmake_parse_arguments(arg "" "LABEL;TIMEOUT;MAKES;NEEDS" "" ${ARGN})
    if(NOT arg_LABEL)
        set(arg_LABEL command)
    endif()
    if(NOT arg_TIMEOUT)
        set(arg_TIMEOUT 600)  # the longest took 330 s on a slow machine
    endif()
    get_filename_component(name ${file} NAME_WE)
    string(REGEX REPLACE "^test_" "" name ${name})
    add_test(NAME commands.${name} COMMAND ${Python3_EXECUTABLE} -m unittest -v ${file}
             WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    # unittest's closing line: nothing failed and something was skipped. COST: what may take longest begins first, so
    # that no core idles at the end.
    set_tests_properties(commands.${name} PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${arg_TIMEOUT} COST ${arg_TIMEOUT}
        SKIP_REGULAR_EXPRESSION "OK \\(skipped=" FIXTURES_SETUP "${arg_MAKES}" FIXTURES_REQUIRED "${arg_NEEDS}")
endfunction()
