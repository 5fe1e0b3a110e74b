# raysheaf_unity(TARGET [ALONE REGEX...]): compiles the target's sources in groups of about sixteen,
# in order, so that shared headers are read once: a full build takes half as long. Sources must
# still include what they use: tools/tidy compiles each by itself. Sources that match a REGEX are
# compiled separately, as are those that Highway compiles once per instruction set (*_simd.cpp).
# Sources that not every build includes must be compiled separately, too.
option(RAYSHEAF_UNITY "Compile sources several at a time" ${PROJECT_IS_TOP_LEVEL})

# Sources of the library that are always compiled separately; headers of a system define many macros.
set(RAYSHEAF_ALONE "/(area_tree_cpu|gltf_draco|gltf_meshopt|image_decode|image_encode|no_cuda|webp_(de|en)code)\\.cpp$|/src/system/")

function(raysheaf_unity target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" ALONE)
  if(NOT RAYSHEAF_UNITY)
    return()
  endif()
  list(APPEND arg_ALONE "_simd\\.cpp$" "${RAYSHEAF_ALONE}")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # In separate compilation, types of an anonymous namespace would be in the main file.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
  list(JOIN arg_ALONE "|" alone)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  list(FILTER sources EXCLUDE REGEX "${alone}")
  list(LENGTH sources count)
  math(EXPR groups "(${count} + 15) / 16")
  set(number 0)
  foreach(source IN LISTS sources)
    math(EXPR group "${number} * ${groups} / ${count}")
    set_source_files_properties("${source}" TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()
