// The parser of a library of Debian's, compiled as the fuzz targets are: with sanitizers, and with
// what tells libFuzzer where an input leads.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
