# Finds MPI if RAYSHEAF_MPI allows it: sets RAYSHEAF_HAS_MPI. It uses the C library, because the
# standard has removed the C++ bindings.
set(RAYSHEAF_HAS_MPI OFF)
if(NOT RAYSHEAF_MPI)
  return()
endif()

include(CheckLanguage)
check_language(C)
if(CMAKE_C_COMPILER)
  enable_language(C)
  find_package(MPI QUIET COMPONENTS C)  # libopenmpi-dev
endif()
if(NOT MPI_C_FOUND)
  if(NOT RAYSHEAF_MPI STREQUAL "AUTO")
    message(FATAL_ERROR "RAYSHEAF_MPI is ${RAYSHEAF_MPI}, but there is no MPI for C: install libopenmpi-dev, "
      "or name the compiler of another one in MPI_C_COMPILER")
  endif()
  message(STATUS "MPI not found: `mpirun raysheaf render` is left out")
  return()
endif()
set(RAYSHEAF_HAS_MPI ON)
