# The Python module: one test per file, the examples in its docstrings and in the pages, its types.
# If the module was not built, a single skipped test reports it.
if(RAYSHEAF_HAS_PYTHON)
  execute_process(COMMAND ${Python_EXECUTABLE} -c "import numpy, pytest"
    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
endif()
if(NOT RAYSHEAF_HAS_PYTHON OR failed)
  add_test(NAME python COMMAND ${CMAKE_COMMAND} -E echo
    "SKIPPED: no Python module was built, or its Python has no numpy and pytest")
  set_tests_properties(python PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED")
  return()
endif()

set(longest_python_test_s 300)
if(CMAKE_CROSSCOMPILING_EMULATOR)
  set(longest_python_test_s 1800)
endif()

function(raysheaf_python_test name)
  add_test(NAME python/${name} COMMAND ${Python_EXECUTABLE} ${ARGN})
  # Exit code 5: pytest found no tests, because a package that they need is missing.
  set_tests_properties(python/${name} PROPERTIES WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    ENVIRONMENT "PYTHONPATH=${PROJECT_BINARY_DIR}/python;PYTHONDONTWRITEBYTECODE=1"
    SKIP_RETURN_CODE 5 TIMEOUT ${longest_python_test_s})
endfunction()

file(GLOB files CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_LIST_DIR} ${CMAKE_CURRENT_LIST_DIR}/test_*.py)
foreach(file ${files})
  string(REGEX REPLACE "^test_(.*)\\.py$" "\\1" name ${file})
  set(chosen "")
  if(CMAKE_CROSSCOMPILING_EMULATOR AND name STREQUAL "process")
    set(chosen -k "not fork")  # under qemu-user, children of a process with several threads may hang
  endif()
  if(name IN_LIST long_python)
    if(NOT RAYSHEAF_LONG_TESTS)
      continue()
    endif()
    raysheaf_python_test(${name} -m pytest tests/python/${file} ${chosen})
    set_tests_properties(python/${name} PROPERTIES LABELS long)
  else()
    raysheaf_python_test(${name} -m pytest tests/python/${file} ${chosen})
  endif()
endforeach()
