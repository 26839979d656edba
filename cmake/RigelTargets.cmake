# What every target of Rigel has in common.

# No operations are fused: a processor with fused multiply-add would give other bits.
add_compile_options(-ffp-contract=off)

# rigel_warnings(target): the warnings that the code base is kept free of.
function(rigel_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Woverloaded-virtual
    $<IF:$<CXX_COMPILER_ID:GNU>,-Wshadow=local,-Wshadow>
    # g++ 12 reports Eigen's own temporaries at -O3.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  if(RIGEL_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# rigel_kernels(a.cc b.cc): files of plain loops (core/cpu_path.h). The compiler may evaluate both
# sides of a choice, which alters no value; and -O2 of g++ 12 leaves most of them scalar.
function(rigel_kernels)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS
    "-fno-math-errno;-fno-trapping-math;-Wno-psabi;$<$<CONFIG:Release,RelWithDebInfo>:-O3>")
endfunction()

# Installed programs and shared libraries find Rigel's shared libraries wherever the prefix is.
file(RELATIVE_PATH RIGEL_BIN_TO_LIB ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set(CMAKE_INSTALL_RPATH $ORIGIN $ORIGIN/${RIGEL_BIN_TO_LIB})

# rigel_library(core SOURCES a.cc b.cc DEPENDS rigel::x): target rigel_core with alias rigel::core, exported as
# rigel::core. BUILD_DEPENDS are header-only libraries that its sources alone include: the installed package does
# without them. Which headers are installed is said in RigelHeaders.cmake.
function(rigel_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS;BUILD_DEPENDS" ${ARGN})
  set(target rigel_${name})
  add_library(${target} ${ARG_SOURCES})
  add_library(rigel::${name} ALIAS ${target})
  rigel_warnings(${target})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  foreach(library IN LISTS ARG_BUILD_DEPENDS)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${library}>)
  endforeach()
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name} VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  install(TARGETS ${target} EXPORT rigelTargets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()
