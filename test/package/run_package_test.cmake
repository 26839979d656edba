# Installs a build of Rigel into a fresh prefix, then configures, builds and runs the project beside this file with it.
#
#   cmake -DRIGEL_BINARY_DIR=DIR -DRIGEL_CONFIG=CONFIG -P run_package_test.cmake
#
# DIR is a finished build; everything is written below DIR/package_test. Generator, compiler and flags are those of DIR.
foreach(variable RIGEL_BINARY_DIR RIGEL_CONFIG)
  if(NOT ${variable})
    message(FATAL_ERROR "${variable} is not set")
  endif()
endforeach()

load_cache(${RIGEL_BINARY_DIR} READ_WITH_PREFIX rigel_
           CMAKE_GENERATOR CMAKE_MAKE_PROGRAM CMAKE_CXX_COMPILER CMAKE_CXX_FLAGS Eigen3_DIR Ceres_DIR CMAKE_PREFIX_PATH)

set(work ${RIGEL_BINARY_DIR}/package_test)
set(prefix ${work}/prefix)
set(build ${work}/build)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(NOTICE "${output}")
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${RIGEL_BINARY_DIR} --config ${RIGEL_CONFIG} --prefix ${prefix})

# The headers that are meant to be, and no others.
include(${CMAKE_CURRENT_LIST_DIR}/../../cmake/RigelHeaders.cmake)
file(GLOB_RECURSE headers RELATIVE ${prefix}/include/rigel ${prefix}/include/rigel/*)
list(SORT headers)
list(SORT RIGEL_HEADERS)
if(NOT headers STREQUAL RIGEL_HEADERS)
  message(FATAL_ERROR "installed are\n${headers}\nand not\n${RIGEL_HEADERS}")
endif()

# No installed file may point back to the source or the build tree.
file(GLOB_RECURSE package_files ${prefix}/*.cmake)
if(NOT package_files)
  message(FATAL_ERROR "no CMake package was installed below ${prefix}")
endif()
foreach(file IN LISTS package_files)
  file(STRINGS ${file} lines REGEX "include/rigel/|${RIGEL_BINARY_DIR}")
  if(lines)
    message(FATAL_ERROR "${file} names the build tree: ${lines}")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${build} -G ${rigel_CMAKE_GENERATOR}
    -DCMAKE_MAKE_PROGRAM=${rigel_CMAKE_MAKE_PROGRAM}
    -DCMAKE_CXX_COMPILER=${rigel_CMAKE_CXX_COMPILER}
    -DCMAKE_CXX_FLAGS=${rigel_CMAKE_CXX_FLAGS}
    -DCMAKE_BUILD_TYPE=${RIGEL_CONFIG}
    -DCMAKE_RUNTIME_OUTPUT_DIRECTORY=${build}/bin
    -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
    "-DCMAKE_PREFIX_PATH=${prefix}\;${rigel_CMAKE_PREFIX_PATH}"
    -DEigen3_DIR=${rigel_Eigen3_DIR}
    -DCeres_DIR=${rigel_Ceres_DIR})
run(${CMAKE_COMMAND} --build ${build} --config ${RIGEL_CONFIG})

find_program(consumer consumer PATHS ${build}/bin ${build}/bin/${RIGEL_CONFIG} NO_DEFAULT_PATH REQUIRED)
run(${consumer})
message(STATUS "${output}")

# The programs of docs/examples: they include what is installed and nothing else.
run(${CMAKE_CTEST_COMMAND} --test-dir ${build}/examples --build-config ${RIGEL_CONFIG} --no-tests=error
    --output-on-failure)
message(STATUS "${output}")

# A program compiled with other flags than the library, by each compiler there is.
file(READ /proc/cpuinfo cpu_flags LIMIT 20000)
foreach(compiler g++ clang++)
  find_program(${compiler}_path ${compiler})
  if(NOT ${compiler}_path)
    message(STATUS "${compiler} is not installed: a program compiled with it is not tested")
    continue()
  endif()
  if(rigel_CMAKE_CXX_FLAGS MATCHES "-fsanitize" AND NOT ${compiler}_path STREQUAL rigel_CMAKE_CXX_COMPILER)
    continue()
  endif()
  set(build ${work}/flags_${compiler})
  run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/flags -B ${build} -G ${rigel_CMAKE_GENERATOR}
      -DCMAKE_MAKE_PROGRAM=${rigel_CMAKE_MAKE_PROGRAM}
      -DCMAKE_CXX_COMPILER=${${compiler}_path}
      -DCMAKE_CXX_FLAGS=${rigel_CMAKE_CXX_FLAGS}
      -DCMAKE_BUILD_TYPE=${RIGEL_CONFIG}
      -DCMAKE_RUNTIME_OUTPUT_DIRECTORY=${build}/bin
      -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
      "-DCMAKE_PREFIX_PATH=${prefix}\;${rigel_CMAKE_PREFIX_PATH}"
      -DEigen3_DIR=${rigel_Eigen3_DIR}
      -DCeres_DIR=${rigel_Ceres_DIR})
  run(${CMAKE_COMMAND} --build ${build} --config ${RIGEL_CONFIG})
  file(GLOB programs ${build}/bin/flags_* ${build}/bin/${RIGEL_CONFIG}/flags_*)
  if(NOT programs)
    message(FATAL_ERROR "no program of ${CMAKE_CURRENT_LIST_DIR}/flags was built")
  endif()
  foreach(program IN LISTS programs)
    get_filename_component(name ${program} NAME)
    if((name STREQUAL flags_avx AND NOT cpu_flags MATCHES " avx ") OR
       (name STREQUAL flags_v3 AND NOT cpu_flags MATCHES " avx2 "))
      message(STATUS "${compiler} ${name}: built, not run: this processor has no such instructions")
      continue()
    endif()
    run(${program})
    if(NOT DEFINED sizes)
      set(sizes "${output}")
    elseif(NOT sizes STREQUAL output)
      message(FATAL_ERROR "${compiler} ${name}: sizes and alignments\n${output}and not\n${sizes}")
    endif()
    message(STATUS "${compiler} ${name}: runs")
  endforeach()
endforeach()
