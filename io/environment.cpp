// Environments from files.
#include <algorithm>
#include <cmath>
#include <string>

#include "io/exr_decode.h"
#include "io/file.h"
#include "io/radiance_hdr.h"
#include "io/refuse.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace {

/// The largest number of binary16, to which most programs clamp radiance.
constexpr float kInfiniteRadiance = 65504;

std::string count_of(std::size_t count, const char* kind) {
  return std::to_string(count) + (count == 1 ? " pixel is " : " pixels are ") + kind;
}

/// Negative values and those that are not a number become 0. Infinite ones become the largest of
/// the map, or that of binary16 if it is larger.
void clamp_radiance(Environment* map, const std::string& path) {
  float brightest = kInfiniteRadiance;
  for (const Vec3& v : map->radiance)
    for (const float x : {v.x, v.y, v.z})
      if (std::isfinite(x)) brightest = std::max(brightest, x);
  std::size_t negative = 0, infinite = 0;
  for (Vec3& v : map->radiance) {
    bool is_negative = false, is_infinite = false;
    for (float* x : {&v.x, &v.y, &v.z}) {
      if (*x >= 0 && std::isfinite(*x)) continue;
      (*x < 0 ? is_negative : is_infinite) = true;
      *x = *x > 0 ? brightest : 0;
    }
    negative += is_negative ? 1 : 0;
    infinite += is_infinite ? 1 : 0;
  }
  std::string text;
  if (negative > 0) text = count_of(negative, "negative");
  if (infinite > 0) text += (text.empty() ? "" : ", ") + count_of(infinite, "not finite");
  if (text.empty()) return;
  map->warnings.push_back("The environment " + path + " is clamped: " + text + ".");
}

}  // namespace

Environment load_environment(const std::string& path) {
  return io::within_memory(path, [&] {
    const io::Bytes file = io::read_file(path);
    const std::string ending = io::ending_of(path);
    if (ending != "hdr" && ending != "exr")
      throw Error(ErrorCode::kUnsupported, "an environment must be a .hdr or .exr file", path);
    Environment map = ending == "hdr" ? io::decode_radiance_hdr(file, path)
                                      : io::decode_exr_environment(file, path);
    clamp_radiance(&map, path);
    map.name = path.substr(path.find_last_of('/') + 1);
    return map;
  });
}

}  // namespace raysheaf
