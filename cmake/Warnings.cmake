# An interface target that all of the project's targets link: the language, the warnings, and the
# floating-point rules. Contraction is off everywhere, so that an expression has the same bits in
# every translation unit, at every SIMD width and on the device. GCC 12's vectoriser of
# straight-line code removes the conversions double -> float -> double, which silently unrounds
# bounds, so it is off. At -O3 GCC 12 warns about overflows and overlaps in inlined library code
# that cannot happen: off, too.
add_library(raysheaf_options INTERFACE)
target_compile_features(raysheaf_options INTERFACE cxx_std_20)
target_compile_options(raysheaf_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Woverloaded-virtual -Wno-stringop-overflow -Wno-restrict
    -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-tree-slp-vectorize>
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${RAYSHEAF_WERROR}>>:-Werror>)

# The headers of Windows have macros `min` and `max`, and much that nothing here needs.
if(WIN32)
  target_compile_definitions(raysheaf_options INTERFACE NOMINMAX WIN32_LEAN_AND_MEAN)
endif()

# Vectors of SVE have no size when they are compiled, so structures cannot hold them, and the kernels'
# structures do: on ARM, Highway compiles for NEON.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  target_compile_definitions(raysheaf_options INTERFACE
    "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
endif()

# Highway's NEON includes AES (which the kernels do not use). Its vectors have constructors that GCC
# inlines only into functions for the same target, and implicit constructors of structures that hold
# vectors are functions for the target of the command line.
function(raysheaf_simd_sources)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(FILTER ARGN INCLUDE REGEX "_simd\\.cpp$")
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -march=armv8-a+crypto)
  endif()
endfunction()
