# What rigel_rig and rigel_match need to read YAML. Sets RIGEL_HAS_YAML, and with it the target rigel_yaml. Nothing that is
# installed for others to link depends on it.
find_package(yaml-cpp QUIET)
set(RIGEL_HAS_YAML ${yaml-cpp_FOUND})
if(NOT RIGEL_HAS_YAML)
  message(STATUS "rigel_rig is not built: not found: yaml-cpp")
  return()
endif()

add_library(rigel_yaml INTERFACE)
if(TARGET yaml-cpp::yaml-cpp)
  target_link_libraries(rigel_yaml INTERFACE yaml-cpp::yaml-cpp)
else()
  target_link_libraries(rigel_yaml INTERFACE yaml-cpp)
endif()
