# Target rigel_docs: the API reference of the headers as HTML in docs/html of the build directory. Among the tests,
# html_docs: it is made without a warning.
find_package(Doxygen QUIET)
if(DOXYGEN_FOUND)
  configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${PROJECT_BINARY_DIR}/docs/Doxyfile @ONLY)
  add_custom_target(rigel_docs
    COMMAND Doxygen::doxygen ${PROJECT_BINARY_DIR}/docs/Doxyfile
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "API reference in ${PROJECT_BINARY_DIR}/docs/html"
    VERBATIM)
elseif(RIGEL_BUILD_DOCS)
  message(STATUS "Doxygen was not found: there is no target rigel_docs")
endif()

if(RIGEL_BUILD_TESTS)
  if(DOXYGEN_FOUND)
    add_test(NAME html_docs WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
             COMMAND $<TARGET_FILE:Doxygen::doxygen> ${PROJECT_BINARY_DIR}/docs/Doxyfile)
  else()
    add_test(NAME html_docs COMMAND ${CMAKE_COMMAND} -E echo "Doxygen is not installed")
  endif()
  set_tests_properties(html_docs PROPERTIES LABELS slow SKIP_REGULAR_EXPRESSION "^Doxygen is not installed")
endif()
