// The cases that `raysheaf verify` draws: a seed stands for the same case on every machine.
#include <gtest/gtest.h>

#include "lab/verify/closed_mesh.h"
#include "lab/verify/pairs.h"
#include "lab/verify/soup.h"
#include "lab/verify/watertight.h"
#include "lab/verify/whole_meshes.h"
#include "tests/bits/checksums.h"

namespace raysheaf::test {
namespace {

using checks::ClosedMesh;
using checks::PairFamily;
using checks::Soup;

TEST(BitsOfDraws, PairsAreTheSameEverywhere) {
  for (const PairFamily& family : checks::pair_families()) {
    checks::Random random(21);
    Checksum sum;
    for (int i = 0; i < 300; ++i) {
      const checks::RayAndTriangle pair = family.make(&random);
      sum.add_all(pair.ray, pair.corners);
    }
    expect_bits("pairs: " + std::string(family.name), sum);
  }
}

TEST(BitsOfDraws, SoupsAndTheirRaysAreTheSameEverywhere) {
  Checksum soups, rays, fans;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    checks::Random random(seed);
    const Soup soup = checks::make_soup(60, {}, &random);
    soups.add_all(std::string_view(soup.kind), soup.scale, soup.offset, soup.meshes);
    rays.add(checks::make_rays(soup, 40, &random));
    fans.add(checks::make_fan(soup, 40, &random));
  }
  expect_bits("soups", soups);
  expect_bits("rays of soups", rays);
  expect_bits("fans of soups", fans);
}

TEST(BitsOfDraws, WholeMeshesAndTheirRaysAreTheSameEverywhere) {
  Checksum meshes, rays;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    checks::Random random(seed);
    const Soup soup = checks::make_whole_meshes(60, &random);
    meshes.add_all(std::string_view(soup.kind), soup.scale, soup.offset, soup.meshes);
    rays.add(checks::make_whole_rays(soup, 40, random.one_in(2), &random));
  }
  expect_bits("meshes of whole numbers", meshes);
  expect_bits("rays of meshes of whole numbers", rays);
}

TEST(BitsOfDraws, ClosedMeshesAndTheirRaysAreTheSameEverywhere) {
  Checksum meshes, rays;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const ClosedMesh mesh = checks::make_closed_mesh(seed);
    meshes.add_all(std::string_view(mesh.kind), mesh.positions, mesh.cores, mesh.extent,
                   mesh.thickness, mesh.offset);
    for (const Triangle& t : mesh.triangles) meshes.add_all(t[0], t[1], t[2]);
    for (std::uint64_t i = 0; i < 40; ++i) rays.add(checks::edge_ray(mesh, seed, i));
  }
  expect_bits("closed meshes", meshes);
  expect_bits("rays at edges of closed meshes", rays);
}

}  // namespace
}  // namespace raysheaf::test
