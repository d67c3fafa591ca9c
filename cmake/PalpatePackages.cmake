# SPDX-License-Identifier: Apache-2.0
# `cpack` in a build folder makes a Debian package of each install component, and a bill of all that they are and stand
# on (SPDX). A file is installed for one component, so no two packages own one. docs/packages.md tells more.
set(CPACK_GENERATOR DEB)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has one of its own
set(CPACK_COMPONENTS_ALL "")
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_POST_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/cmake/packages/bill.cmake")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The Palpate authors <maintainers@palpate.invalid>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# palpate_package(<component> NAME ... SUMMARY ... DESCRIPTION ... SOURCES folder... [SECTION ...] [DEPENDS ...]
#                 [RECOMMENDS ...] [SUGGESTS ...]): one package. SOURCES: what it is compiled from, whose SPDX lines its
# copyright file sums up; that, the changelog and the manual pages are written while it is installed. Libraries that its
# programs load are dependencies by themselves.
function(palpate_package component)
    cmake_parse_arguments(arg "" "NAME;SUMMARY;DESCRIPTION;SECTION" "SOURCES;DEPENDS;RECOMMENDS;SUGGESTS" ${ARGN})
    get_property(commands GLOBAL PROPERTY PALPATE_COMMANDS_OF_${component})
    string(JOIN "\" \"" words ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/packages/documents.py ${arg_NAME}
           ${PROJECT_VERSION} --programs ${CMAKE_BINARY_DIR}/bin --sources ${arg_SOURCES} --commands ${commands})
    install(CODE "execute_process(COMMAND \"${words}\" --share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share\"
                                  COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
    string(TOUPPER ${component} COMPONENT)
    set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME ${arg_NAME} PARENT_SCOPE)
    set(CPACK_DEBIAN_${COMPONENT}_DESCRIPTION "${arg_SUMMARY}\n${arg_DESCRIPTION}" PARENT_SCOPE)
    if(arg_SECTION)
        set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_SECTION ${arg_SECTION} PARENT_SCOPE)
    endif()
    foreach(relation DEPENDS RECOMMENDS SUGGESTS)
        list(JOIN arg_${relation} ", " packages)
        set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_${relation} "${packages}" PARENT_SCOPE)
    endforeach()
    set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
endfunction()

set(same_runtime "palpate-runtime (= ${PROJECT_VERSION})")
palpate_package(runtime NAME palpate-runtime SOURCES formats runtime tools/cli
    SUMMARY "touch a patient's organ at 1 kHz"
    DESCRIPTION "Renders the forces of an organ made by palpate-tools on a haptic device,
or on a simulated one, without a window, and checks what a machine lacks for it.")
palpate_package(dev NAME libpalpate-dev SECTION libdevel SOURCES formats runtime
    SUMMARY "haptic organs and their contact, for programs of one's own"
    DESCRIPTION "Static libraries, headers and a CMake package: reading and writing the
asset, collision, contact and force, devices, recordings."
    DEPENDS libeigen3-dev libhdf5-dev libssl-dev)
if(PALPATE_VISUAL)
    palpate_package(trainer NAME palpate-trainer SOURCES formats runtime tools/cli
        SUMMARY "train hands on a patient's organ"
        DESCRIPTION "A window in which an organ made by palpate-tools is seen and touched, with
exercises, scores, recordings and their playback."
        DEPENDS "${same_runtime}" SUGGESTS xvfb)
endif()
if(PALPATE_TOOLS)
    palpate_package(tools NAME palpate-tools SOURCES formats runtime tools pipelines
        SUMMARY "make an organ that a hand can feel of a patient's CT or MRI"
        DESCRIPTION "Segments a volume, fills organs with tetrahedra, condenses their stiffness
into one file, checks and reports it, for one patient or for many."
        DEPENDS "${same_runtime}" python3
        RECOMMENDS snakemake xvfb SUGGESTS palpate-trainer slurm-client)
endif()
include(CPack)
