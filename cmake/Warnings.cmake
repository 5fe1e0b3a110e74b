# One interface target that every target of ours links: the language, the warnings, the floating-point
# contract. Contraction is off everywhere, so that an expression has the same bits in every translation
# unit, at every SIMD width and on the device. GCC 12's vectoriser of straight-line code takes the pair of
# conversions double -> float -> double for nothing and drops it, which silently unrounds bounds: it is off.
# At -O3 GCC 12 warns of overflows and overlaps in inlined library code that cannot happen: off, too.
add_library(raysheaf_options INTERFACE)
target_compile_features(raysheaf_options INTERFACE cxx_std_20)
target_compile_options(raysheaf_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Woverloaded-virtual -Wno-stringop-overflow -Wno-restrict
    -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-tree-slp-vectorize>
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${RAYSHEAF_WERROR}>>:-Werror>)
