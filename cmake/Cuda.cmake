# Finds the device compiler if RAYSHEAF_CUDA allows it: sets RAYSHEAF_HAS_CUDA, and adds its flags
# to raysheaf_options.
set(RAYSHEAF_HAS_CUDA OFF)
if(NOT RAYSHEAF_CUDA)
  return()
endif()

if(NOT CMAKE_CUDA_COMPILER)
  unset(CMAKE_CUDA_COMPILER CACHE)  # it may have been installed since the last run
endif()
include(CheckLanguage)
check_language(CUDA)
if(NOT CMAKE_CUDA_COMPILER)
  if(NOT RAYSHEAF_CUDA STREQUAL "AUTO")
    message(FATAL_ERROR "RAYSHEAF_CUDA is ${RAYSHEAF_CUDA}, but there is no CUDA compiler that works: "
      "put nvcc on the PATH or name it in CMAKE_CUDA_COMPILER")
  endif()
  message(STATUS "Device code: left out, there is no CUDA compiler")
  return()
endif()

# PTX of the oldest architecture, which every later device can compile for itself, and machine code
# for one, so that all code goes through the whole compiler. Each further architecture adds the same
# compile time; the preset `cuda` has all of them.
if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES "75-virtual;90-real" CACHE STRING "CUDA architectures")
endif()
enable_language(CUDA)
if(CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 12.0)
  if(NOT RAYSHEAF_CUDA STREQUAL "AUTO")
    message(FATAL_ERROR "RAYSHEAF_CUDA is ${RAYSHEAF_CUDA}, but nvcc ${CMAKE_CUDA_COMPILER_VERSION} "
      "does not support C++20: 12.0 is the first that does")
  endif()
  message(STATUS "Device code: left out, nvcc ${CMAKE_CUDA_COMPILER_VERSION} does not support C++20")
  return()
endif()
set(RAYSHEAF_HAS_CUDA ON)
message(STATUS "Device code: nvcc ${CMAKE_CUDA_COMPILER_VERSION} for ${CMAKE_CUDA_ARCHITECTURES}")
if(CMAKE_CXX_COMPILER_LAUNCHER AND NOT DEFINED CMAKE_CUDA_COMPILER_LAUNCHER)
  set(CMAKE_CUDA_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# Enables assertions if the host's are enabled.
if(NOT CMAKE_CXX_FLAGS_RELWITHDEBINFO MATCHES NDEBUG)
  string(REPLACE "-DNDEBUG" "" CMAKE_CUDA_FLAGS_RELWITHDEBINFO "${CMAKE_CUDA_FLAGS_RELWITHDEBINFO}")
endif()

# CMake 3.25 silently drops CMAKE_CUDA_STANDARD 20, hence -std. The floating-point rules are those
# of Warnings.cmake, for the device and for the host's half of each file. -Wpedantic is left out,
# because nvcc generates code that violates it.
target_compile_options(raysheaf_options INTERFACE
  $<$<COMPILE_LANGUAGE:CUDA>:-std=c++20 --expt-relaxed-constexpr --extended-lambda --fmad=false
    -Xcompiler=-Wall,-Wextra,-Wshadow
    -Xcompiler=-ffp-contract=off,-fno-math-errno,-fno-trapping-math,-fno-tree-slp-vectorize>
  $<$<AND:$<COMPILE_LANGUAGE:CUDA>,$<BOOL:${RAYSHEAF_WERROR}>>:-Werror=all-warnings -Xcompiler=-Werror>)
