# SPDX-License-Identifier: Apache-2.0
# find_package(Palpate COMPONENTS formats runtime) for other projects; tests/consumer is one.
include(CMakePackageConfigHelpers)
get_property(palpate_installed GLOBAL PROPERTY PALPATE_INSTALLED_LIBRARIES)
install(TARGETS ${palpate_installed} EXPORT PalpateTargets ARCHIVE DESTINATION lib COMPONENT dev)
install(EXPORT PalpateTargets NAMESPACE Palpate:: DESTINATION lib/cmake/Palpate COMPONENT dev)
configure_package_config_file(cmake/PalpateConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/PalpateConfig.cmake"
    INSTALL_DESTINATION lib/cmake/Palpate)
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/PalpateConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/PalpateConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/PalpateConfigVersion.cmake"
    DESTINATION lib/cmake/Palpate COMPONENT dev)
# Debian has both texts in /usr/share/common-licenses, so no package takes them.
install(DIRECTORY LICENSES DESTINATION share/doc/palpate COMPONENT licences)
