# Installs the headers and the CMake package:
#   find_package(rigel 0.2 REQUIRED [COMPONENTS core minimal refine problems])
include(CMakePackageConfigHelpers)

set(RIGEL_INSTALL_CMAKEDIR ${CMAKE_INSTALL_LIBDIR}/cmake/rigel)

include(cmake/RigelHeaders.cmake)
foreach(header IN LISTS RIGEL_HEADERS)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rigel/${folder})
endforeach()

install(EXPORT rigelTargets NAMESPACE rigel:: DESTINATION ${RIGEL_INSTALL_CMAKEDIR})

configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/rigelConfig.cmake.in ${PROJECT_BINARY_DIR}/cmake/rigelConfig.cmake
  INSTALL_DESTINATION ${RIGEL_INSTALL_CMAKEDIR})
write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/cmake/rigelConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cmake/rigelConfig.cmake
              ${PROJECT_BINARY_DIR}/cmake/rigelConfigVersion.cmake
        DESTINATION ${RIGEL_INSTALL_CMAKEDIR})

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
