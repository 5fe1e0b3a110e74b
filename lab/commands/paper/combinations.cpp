#include "lab/commands/paper/combinations.h"

namespace raysheaf::app {
namespace {

using ConeTest = Quirks::ConeTest;

constexpr ConeTest kConeTests[] = {ConeTest::kSigned, ConeTest::kUnsigned, ConeTest::kExact};

const char* cone_name(ConeTest test) {
  return test == ConeTest::kSigned ? "signed" : test == ConeTest::kUnsigned ? "unsigned" : "exact";
}

/// The three keys: as coded, with the intended azimuth, and the key of `crsh`.
std::vector<Quirks> with_each_key(Quirks quirks) {
  std::vector<Quirks> all{quirks};
  quirks.azimuth_as_coded = false;
  all.push_back(quirks);
  quirks.hash_as_coded = false;
  all.push_back(quirks);
  return all;
}

Quirks exact_counting() {
  Quirks quirks;
  quirks.padded_counting = false;
  return quirks;
}

Quirks undersized_triangles() {
  Quirks quirks;
  quirks.undersized_triangle_spheres = true;
  return quirks;
}

std::vector<Quirks> of_rah() {
  std::vector<Quirks> all;
  for (const ConeTest test : kConeTests) {
    for (const bool from_below : {true, false}) {
      Quirks quirks;
      quirks.cone_test = test;
      quirks.rows_from_below = from_below;
      all.push_back(quirks);
    }
  }
  all.push_back(undersized_triangles());
  all.push_back(exact_counting());
  return all;
}

std::vector<Quirks> of_crsh() {
  std::vector<Quirks> all;
  for (const ConeTest test : kConeTests) {
    Quirks quirks;
    quirks.cone_test = test;
    for (const Quirks& q : with_each_key(quirks)) all.push_back(q);
  }
  Quirks from_above, unrotated;
  from_above.rows_from_below = false;
  unrotated.unrotated_mesh_spheres = true;
  for (const Quirks& q : {from_above, unrotated, undersized_triangles(), exact_counting()})
    all.push_back(q);
  return all;
}

}  // namespace

std::vector<Quirks> combinations_of(Method method) {
  return method == Method::kCrsh ? of_crsh() : of_rah();
}

std::vector<Quirks> phases() {
  std::vector<Quirks> all(1);
  for (std::uint32_t dropped = 1; dropped <= 32; dropped *= 2) {
    all.emplace_back();
    all.back().dropped_rays = dropped;
  }
  return all;
}

std::string name_of(const Quirks& quirks) {
  std::string name = cone_name(quirks.cone_test);
  if (!quirks.hash_as_coded) {
    name += ", crsh key";
  } else if (!quirks.azimuth_as_coded) {
    name += ", azimuth by y and x";
  }
  if (!quirks.rows_from_below) name += ", rows from above";
  if (quirks.undersized_triangle_spheres) name += ", undersized triangles";
  if (quirks.unrotated_mesh_spheres) name += ", unrotated meshes";
  if (!quirks.padded_counting) name += ", exact counting";
  return name;
}

}  // namespace raysheaf::app
