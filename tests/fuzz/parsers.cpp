// Compiles a parser of a Debian library like the fuzz targets: with sanitizers and libFuzzer's
// coverage.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
