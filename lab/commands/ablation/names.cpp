// Names of the choices of the ablation.
#include "lab/commands/ablation/ablation.h"
#include "raysheaf/error.h"

namespace raysheaf::app {

std::vector<LabRays> all_lab_rays() {
  return {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2,
          LabRays::kAmbientOcclusion};
}

std::vector<RayKey> all_keys() {
  std::vector<RayKey> keys;
  for (const RayKeyEntry& entry : kRayKeys) keys.push_back(entry.key);
  return keys;
}

std::vector<BundleBound> all_bounds() {
  return {BundleBound::kSphereCone, BundleBound::kFiniteCone, BundleBound::kShaft,
          BundleBound::kFrustum, BundleBound::kShaftAndCone};
}

const char* to_string(LabRays rays) {
  switch (rays) {
    case LabRays::kShadow:
      return "shadow";
    case LabRays::kReflection1:
      return "reflection1";
    case LabRays::kReflection2:
      return "reflection2";
    case LabRays::kAmbientOcclusion:
      break;
  }
  return "ao";
}

LabRays lab_rays_from_string(const std::string& name) {
  for (const LabRays rays : all_lab_rays())
    if (name == to_string(rays)) return rays;
  throw Error(
      ErrorCode::kInvalidArgument,
      "no rays are called \"" + name + "\"; the names are shadow, reflection1, reflection2 and ao",
      "rays");
}

bool comes_in_both_widths(RayKey key) {
  return entry_of(key).cell != KeyCell::kNone && entry_of(key).cell != KeyCell::kPixel;
}

KeyWords words_of(RayKey key) {
  switch (entry_of(key).cell) {
    case KeyCell::kNone:
      if (key == RayKey::kRaster) break;
      return {key == RayKey::kCrsh ? "key crsh" : "published hashes",
              "the hash contains what differs between rays of this kind"};
    case KeyCell::kPixel:
      break;
    case KeyCell::kSpherical:
    case KeyCell::kOctahedral:
      return {"direction",
              "rays that start together differ only in direction, and all bits describe it"};
    case KeyCell::kEnd:
      return {"end point", "rays that start together and end together make a thin bundle"};
    case KeyCell::kOctahedralAndStart:
      return {"direction and origin",
              "direction and origin determine a ray, and the rays of a leaf agree in both"};
    case KeyCell::kStartAndEnd:
      return {"origin and exit",
              "the rays of a leaf start in one small box and leave the scene through another"};
  }
  return {"pixel order",
          "neighbours in the image are neighbours in the scene, and nothing is sorted twice"};
}

const char* reason_of(BundleBound bound) {
  switch (bound) {
    case BundleBound::kSphereCone:
      return "a sphere and a cone are the cheapest to test";
    case BundleBound::kFiniteCone:
      return "the cone ends where its rays end";
    case BundleBound::kShaft:
      return "the hull of two boxes is as wide as the rays, from their origins to their ends";
    case BundleBound::kFrustum:
      return "four planes follow the spread of the rays in two directions separately, while a cone "
             "takes the larger spread";
    case BundleBound::kShaftAndCone:
      break;
  }
  return "the cone cuts the corners off the shaft, and the shaft cuts the flat sides off the cone";
}

}  // namespace raysheaf::app
