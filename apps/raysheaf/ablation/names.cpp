// What the ablation may choose from, by name.
#include "ablation/ablation.h"
#include "raysheaf/error.h"

namespace raysheaf::app {

std::vector<LabRays> all_lab_rays() {
  return {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2,
          LabRays::kAmbientOcclusion};
}

std::vector<RayKey> all_keys() {
  return {RayKey::kRaster,           RayKey::kPixelMorton,       RayKey::kCrsh,
          RayKey::kPublished,        RayKey::kCorrected,         RayKey::kSphericalMorton,
          RayKey::kOctahedralMorton, RayKey::kOctahedralHilbert, RayKey::kEndPointHilbert,
          RayKey::kFiveMorton,       RayKey::kFiveHilbert,       RayKey::kTwoPointMorton,
          RayKey::kTwoPointHilbert};
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
      "there are no rays \"" + name + "\"; there are shadow, reflection1, reflection2 and ao",
      "rays");
}

bool comes_in_both_widths(RayKey key) {
  return key >= RayKey::kSphericalMorton;
}

}  // namespace raysheaf::app
