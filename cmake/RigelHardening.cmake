# What makes a memory error end in an abort and not in something worse: for optimized builds, of Rigel's own targets
# alone. A sanitizer finds more by itself, and does not go together with checked copies.
if(NOT RIGEL_HARDENING OR NOT CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang" OR CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  return()
endif()

set(optimized $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
add_compile_options($<${optimized}:-fstack-protector-strong>
                    $<${optimized}:-U_FORTIFY_SOURCE> $<${optimized}:-D_FORTIFY_SOURCE=2>)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  add_link_options($<${optimized}:LINKER:-z,relro,-z,now>)
endif()

# CMAKE_POSITION_INDEPENDENT_CODE then makes programs position independent, too.
include(CheckPIESupported)
check_pie_supported(OUTPUT_VARIABLE pie_output LANGUAGES CXX)
if(NOT CMAKE_CXX_LINK_PIE_SUPPORTED)
  message(STATUS "Programs are not position independent: ${pie_output}")
endif()
