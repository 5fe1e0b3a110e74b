# Finds a Python with nanobind for the Python module if RAYSHEAF_PYTHON allows it: sets
# RAYSHEAF_HAS_PYTHON. Name the interpreter in Python_EXECUTABLE: the first on the PATH may be a
# shim.
set(RAYSHEAF_HAS_PYTHON OFF)
if(NOT RAYSHEAF_PYTHON)
  return()
endif()

# CMake and nanobind cache properties of one interpreter that are wrong for another.
if(NOT "${Python_EXECUTABLE}" STREQUAL "${RAYSHEAF_PYTHON_BEFORE}")
  foreach(remembered _Python_EXECUTABLE _Python_INCLUDE_DIR _Python_INTERPRETER_PROPERTIES
      _Python_INTERPRETER_SIGNATURE nanobind_DIR NB_SUFFIX NB_SUFFIX_S NB_ABI)
    unset(${remembered} CACHE)
  endforeach()
  set(RAYSHEAF_PYTHON_BEFORE "${Python_EXECUTABLE}" CACHE INTERNAL "")
endif()
set(missing "")
# CMake does not look for the headers of an emulated Python where it says that they are.
if(CMAKE_CROSSCOMPILING AND Python_EXECUTABLE)
  execute_process(COMMAND ${Python_EXECUTABLE} -c "import sysconfig; print(sysconfig.get_path('include'))"
    OUTPUT_VARIABLE python_headers OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  set(Python_INCLUDE_DIR ${CMAKE_SYSROOT}${python_headers})
endif()
find_package(Python 3.10 QUIET COMPONENTS Interpreter Development.Module)
if(NOT Python_FOUND)
  set(missing "there is no Python 3.10 or newer with its headers")
else()
  execute_process(COMMAND ${Python_EXECUTABLE} -m nanobind --cmake_dir
    OUTPUT_VARIABLE nanobind_dir OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed ERROR_QUIET)
  if(failed)
    set(missing "${Python_EXECUTABLE} has no nanobind")
  endif()
endif()
if(missing)
  if(NOT RAYSHEAF_PYTHON STREQUAL "AUTO")
    message(FATAL_ERROR "RAYSHEAF_PYTHON is ${RAYSHEAF_PYTHON}, but ${missing}")
  endif()
  message(STATUS "Python module: left out, ${missing}")
  return()
endif()
find_package(nanobind 3 REQUIRED CONFIG PATHS ${nanobind_dir} NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
set(RAYSHEAF_HAS_PYTHON ON)
message(STATUS "Python module: for ${Python_EXECUTABLE} ${Python_VERSION}")
