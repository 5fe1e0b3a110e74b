# The device compiler, where RAYSHEAF_CUDA wants it and there is one: sets RAYSHEAF_HAS_CUDA and tells
# raysheaf_options the flags.
set(RAYSHEAF_HAS_CUDA OFF)
if(NOT RAYSHEAF_CUDA)
  return()
endif()

if(NOT CMAKE_CUDA_COMPILER)
  unset(CMAKE_CUDA_COMPILER CACHE)  # one that was missing last time may have come
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

# PTX of the oldest architecture, which every later device can compile for itself, and machine code for
# one: enough to have everything through the whole compiler. Each more takes as long again; the preset
# `cuda` has them all.
if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES "75-virtual;90-real" CACHE STRING "CUDA architectures")
endif()
enable_language(CUDA)
if(CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 12.0)
  if(NOT RAYSHEAF_CUDA STREQUAL "AUTO")
    message(FATAL_ERROR "RAYSHEAF_CUDA is ${RAYSHEAF_CUDA}, but nvcc ${CMAKE_CUDA_COMPILER_VERSION} "
      "does not speak C++20: 12.0 is the first that does")
  endif()
  message(STATUS "Device code: left out, nvcc ${CMAKE_CUDA_COMPILER_VERSION} does not speak C++20")
  return()
endif()
set(RAYSHEAF_HAS_CUDA ON)
message(STATUS "Device code: nvcc ${CMAKE_CUDA_COMPILER_VERSION} for ${CMAKE_CUDA_ARCHITECTURES}")
if(CMAKE_CXX_COMPILER_LAUNCHER AND NOT DEFINED CMAKE_CUDA_COMPILER_LAUNCHER)
  set(CMAKE_CUDA_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# Assertions where the host's are.
if(NOT CMAKE_CXX_FLAGS_RELWITHDEBINFO MATCHES NDEBUG)
  string(REPLACE "-DNDEBUG" "" CMAKE_CUDA_FLAGS_RELWITHDEBINFO "${CMAKE_CUDA_FLAGS_RELWITHDEBINFO}")
endif()

# CMake 3.25 drops CMAKE_CUDA_STANDARD 20 without a word, hence -std. The floating-point contract is
# that of Warnings.cmake, for the device and for the host's half of each file. -Wpedantic is left out:
# what nvcc generates is not pedantic.
target_compile_options(raysheaf_options INTERFACE
  $<$<COMPILE_LANGUAGE:CUDA>:-std=c++20 --expt-relaxed-constexpr --extended-lambda --fmad=false
    -Xcompiler=-Wall,-Wextra,-Wshadow
    -Xcompiler=-ffp-contract=off,-fno-math-errno,-fno-trapping-math,-fno-tree-slp-vectorize>
  $<$<AND:$<COMPILE_LANGUAGE:CUDA>,$<BOOL:${RAYSHEAF_WERROR}>>:-Werror=all-warnings -Xcompiler=-Werror>)
