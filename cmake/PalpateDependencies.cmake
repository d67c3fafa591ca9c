# SPDX-License-Identifier: Apache-2.0
# Every library Palpate stands on, found once, with the reason it was chosen.

find_package(Threads REQUIRED)
# Eigen: value types and small dense algebra; header-only, so the runtime carries nothing with it.
# NO_MODULE, and before ITK, whose own FindEigen3 would shadow it.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
# Its types change size and its memory owner with the vector instructions a program is compiled for; here they do not.
# formats/records passes this on to whoever links us, and formats/records/eigen_layout.hpp checks it.
add_compile_definitions(EIGEN_MAX_ALIGN_BYTES=16)
# HDF5 C interface: the asset; VTK and h5py read the same file. HighFive is not in Debian 12.
set(HDF5_PREFER_PARALLEL FALSE)
find_package(HDF5 1.10 REQUIRED COMPONENTS C)
# OpenSSL's libcrypto: SHA-256 with the CPU's SHA instructions; a 100 MB compliance must be hashed while loading.
find_package(OpenSSL 3 REQUIRED COMPONENTS Crypto)
# CLI11 (options and help), spdlog over fmt (talk on stderr), nlohmann-json (results): small, typed, in Debian.
find_package(PkgConfig REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(spdlog REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json 3 REQUIRED)
# toml++: files that people write; keeps line and column of every value for error messages.
find_package(tomlplusplus 3 REQUIRED)

# OpenIGTLink: the protocol by which trackers and 3D Slicer exchange poses; its C structures and CRC, and in
# tests its own sockets as the peer. Debian's UseOpenIGTLink.cmake changes global flags (-fno-tree-vectorize,
# include folders) and its config names no target, so the target is ours.
find_path(PALPATE_OPENIGTLINK_INCLUDE igtl_header.h PATH_SUFFIXES openigtlink REQUIRED)
find_library(PALPATE_OPENIGTLINK_LIBRARY OpenIGTLink REQUIRED)
add_library(OpenIGTLink::OpenIGTLink UNKNOWN IMPORTED)
set_target_properties(OpenIGTLink::OpenIGTLink PROPERTIES IMPORTED_LOCATION "${PALPATE_OPENIGTLINK_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${PALPATE_OPENIGTLINK_INCLUDE}")

# Python: writes manual pages and copyright files, runs tests. Debian's own interpreter: it sees python3-h5py.
find_program(Python3_EXECUTABLE python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_package(Python3 REQUIRED COMPONENTS Interpreter)

if(PALPATE_TOOLS)
    # ITK: the reference implementation of volume reading, DICOM geometry and segmentation filters.
    find_package(ITK 5.2 REQUIRED COMPONENTS
        ITKCommon ITKIOImageBase ITKIONIFTI ITKIONRRD ITKIOMeta ITKZLIB
        ITKConnectedComponents ITKCurvatureFlow ITKDistanceMap ITKLabelMap)
    # DCMTK's dcmseg: the reference reader of DICOM segmentation objects, which ITK and GDCM lack.
    set(PALPATE_DCMTK_LIBRARIES)
    foreach(part seg fg iod data)
        find_library(PALPATE_DCM_${part}_LIBRARY dcm${part} REQUIRED)
        list(APPEND PALPATE_DCMTK_LIBRARIES ${PALPATE_DCM_${part}_LIBRARY})
    endforeach()
    foreach(part oflog ofstd)
        find_library(PALPATE_DCM_${part}_LIBRARY ${part} REQUIRED)
        list(APPEND PALPATE_DCMTK_LIBRARIES ${PALPATE_DCM_${part}_LIBRARY})
    endforeach()
    # zlib: what is packed in a .nii.gz, when names are looked for in it.
    find_package(ZLIB REQUIRED)
    # GDCM: series and slices of DICOM. ITK reads them through it without passing it on, so it is found by itself.
    find_path(PALPATE_GDCM_INCLUDE gdcmTrace.h PATH_SUFFIXES gdcm-3.0 REQUIRED)
    set(PALPATE_GDCM_LIBRARIES)
    foreach(part MSFF DSED DICT Common)
        find_library(PALPATE_GDCM_${part}_LIBRARY gdcm${part} REQUIRED)
        list(APPEND PALPATE_GDCM_LIBRARIES ${PALPATE_GDCM_${part}_LIBRARY})
    endforeach()
    # CGAL Mesh_3: multi-domain Delaunay refinement with sliver removal, from any labelling function.
    find_package(CGAL 5.5 REQUIRED)
    # FCL: distance and overlap of meshes by other people's code, a judge in `palpate bench sixdof`.
    find_package(fcl 0.7 REQUIRED)
    # Bullet: depth of one mesh in another, another judge there. In double precision, of which Debian has the libraries but no
    # CMake package that finds them; collision alone.
    pkg_check_modules(PALPATE_BULLET REQUIRED IMPORTED_TARGET bullet-float64)
    # CHOLMOD (supernodal Cholesky), METIS (ordering), LAPACK (dpotri): condensation at the machine's limit.
    find_path(PALPATE_CHOLMOD_INCLUDE cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
    find_library(PALPATE_CHOLMOD_LIBRARY cholmod REQUIRED)
    find_path(PALPATE_METIS_INCLUDE metis.h REQUIRED)
    find_library(PALPATE_METIS_LIBRARY metis REQUIRED)
    find_library(PALPATE_OPENBLAS_LIBRARY openblas REQUIRED)
    find_library(PALPATE_LAPACKE_LIBRARY lapacke REQUIRED)
endif()

if(PALPATE_TOOLS OR PALPATE_VISUAL)
    # VTK: surface filters, pictures for the report, the trainer's scene; ITK's users know it. Films of runs go through its
    # Ogg Theora writer: Debian's VTK is built without IOFFMPEG, and the codec is free and in one file with its container.
    find_package(VTK 9.1 REQUIRED COMPONENTS
        CommonCore CommonDataModel CommonTransforms FiltersCore FiltersGeneral FiltersGeometry FiltersModeling
        FiltersSources FiltersVerdict ImagingCore ImagingStencil IOCore IOGeometry IOHDF IOImage IOLegacy IOOggTheora IOXML
        InteractionStyle RenderingAnnotation RenderingContext2D RenderingContextOpenGL2 RenderingCore RenderingFreeType RenderingOpenGL2 RenderingUI
        ChartsCore ViewsContext2D)
    # Xlib, which VTK draws through: asks whether a display answers, where VTK would abort.
    find_package(X11 REQUIRED)
endif()
if(PALPATE_VISUAL)
    # OpenAL Soft: plays a tone whose pitch follows the force, through PulseAudio, PipeWire or ALSA, with a thread of its own
    # and few libraries behind it (SDL would bring a window of its own); its wave backend writes a file in tests.
    find_package(OpenAL REQUIRED)
    # GNU gettext: translators know its files, the C library reads them; msgfmt packs and checks them.
    find_package(Gettext REQUIRED)
endif()

if(PALPATE_TESTS)
    find_package(GTest REQUIRED)
    include(GoogleTest)
    if(DEFINED ENV{PALPATE_DATA})
        set(palpate_data_default "$ENV{PALPATE_DATA}")
    else()
        set(palpate_data_default "${PROJECT_SOURCE_DIR}/../shared/data")
    endif()
    set(PALPATE_DATA "${palpate_data_default}" CACHE PATH "Real volumes for tests; tests that need them are skipped where they are absent")
    # What every test sees. ctest reads it: gtest_discover_tests() hands on the first variable of several alone.
    # One thread of linear algebra each but where a test says otherwise: there are as many tests at once as cores.
    file(CONFIGURE OUTPUT test_environment.cmake CONTENT [[
set(ENV{PALPATE_THREADS} 1)
set(ENV{OPENBLAS_NUM_THREADS} 1)
set(ENV{PALPATE_DATA} "@PALPATE_DATA@")
set(ENV{PALPATE_BIN} "@CMAKE_BINARY_DIR@/bin")
set(ENV{PALPATE_SOURCE} "@PROJECT_SOURCE_DIR@")
set(ENV{PALPATE_BUILD} "@CMAKE_BINARY_DIR@")
]] @ONLY)
    set_property(DIRECTORY "${PROJECT_SOURCE_DIR}" APPEND PROPERTY TEST_INCLUDE_FILES "${CMAKE_BINARY_DIR}/test_environment.cmake")
endif()
