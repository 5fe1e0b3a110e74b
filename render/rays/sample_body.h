// The numbers in [0, 1) from which a sample of the image makes its choices: the position in the
// pixel, on the lens and on each light.
//
//   index of the sample ──► shuffled ──► two dimensions of Sobol' ──► scrambled ──► [0, 1)^2
//                              ▲                                         ▲
//                              └───────────── seed of the choice ────────┘
//
// Each choice of each pixel has its own (0,2)-sequence (I. M. Sobol', 1967; the first two
// dimensions), with Owen shuffling and scrambling by hashes (A. Owen, "Randomly Permuted
// (t,m,s)-Nets and (t,s)-Sequences", 1995; B. Burley, "Practical Hash-based Owen Scrambling", JCGT
// 9(4), 2020): among every 2^k successive samples, each elementary interval of the square contains
// its share. A number depends only on (sample, seed), not on threads, order or method.
#pragma once

#include <cstdint>

#include "base/host_device.h"
#include "base/trigonometry.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// The index of a sample, and the number of samples. An image with one sample makes every choice in
/// the middle: rays through the centres of pixels and of the lens, to the centres of lights.
struct SampleOf {
  std::uint32_t index = 0, count = 1;
};

RAYSHEAF_HD inline std::uint32_t reversed_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0xff00ff00u) >> 8) | ((x & 0x00ff00ffu) << 8);
  x = ((x & 0xf0f0f0f0u) >> 4) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x & 0xccccccccu) >> 2) | ((x & 0x33333333u) << 2);
  return ((x & 0xaaaaaaaau) >> 1) | ((x & 0x55555555u) << 1);
}

/// A seed every bit of which depends on both arguments (the finaliser of A. Appleby's MurmurHash3,
/// 2011).
RAYSHEAF_HD inline std::uint32_t mixed_seed(std::uint32_t seed, std::uint32_t with) {
  std::uint32_t h = seed ^ (with * 0x9e3779b9u + 0x7f4a7c15u);
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}

/// Flips each bit by a hash of the bits above it: Owen's scrambling. Multiplications by even
/// numbers only carry upwards, so it works on the reversed number (Burley 2020, section 3, after S.
/// Laine and T. Karras, "Stratified Sampling for Stochastic Transparency", EGSR 2011).
RAYSHEAF_HD inline std::uint32_t owen_scrambled(std::uint32_t x, std::uint32_t seed) {
  x = reversed_bits(x) + seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return reversed_bits(x);
}

/// The second dimension of Sobol's sequence as a 32-bit fraction; the first is `reversed_bits`. Its
/// matrix is Pascal's triangle modulo 2, a Kronecker power of (1 1; 0 1): five butterflies.
RAYSHEAF_HD inline std::uint32_t sobol_second(std::uint32_t index) {
  index ^= (index & 0xaaaaaaaau) >> 1;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xffff0000u) >> 16;
  return reversed_bits(index);
}

/// The 24 leading bits as a float in [0, 1).
RAYSHEAF_HD inline float unit_fraction(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

/// Point `index` of the sequence that belongs to `seed`, as two 32-bit fractions.
struct FractionPair {
  std::uint32_t x = 0, y = 0;
};
RAYSHEAF_HD inline FractionPair scrambled_sobol(std::uint32_t index, std::uint32_t seed) {
  const std::uint32_t shuffled = owen_scrambled(index, mixed_seed(seed, 0));
  return {owen_scrambled(reversed_bits(shuffled), mixed_seed(seed, 1)),
          owen_scrambled(sobol_second(shuffled), mixed_seed(seed, 2))};
}

/// The random choices of a sample; each kind has its own sequences.
enum class Choice : std::uint32_t { kPixel, kLens, kLight, kSky };

/// `pixel` and `path` identify the fragment that chooses; `which` numbers choices of one kind.
RAYSHEAF_HD inline std::uint32_t choice_seed(Choice choice, std::uint32_t pixel, std::uint32_t path,
                                             std::uint32_t which) {
  const std::uint32_t kind = mixed_seed(static_cast<std::uint32_t>(choice), which);
  return mixed_seed(mixed_seed(kind, pixel), path);
}

/// Two numbers in [0, 1), or the middle if there is only one sample.
RAYSHEAF_HD inline Vec2 sample_pair(SampleOf sample, std::uint32_t seed) {
  if (sample.count == 1) return {0.5f, 0.5f};
  const FractionPair bits = scrambled_sobol(sample.index, seed);
  return {unit_fraction(bits.x), unit_fraction(bits.y)};
}

/// The point on the unit circle at this fraction of a turn.
RAYSHEAF_HD inline Vec2 on_circle(float part) {
  const portable::SineCosine angle =
      portable::sine_cosine(2 * portable::kPi * static_cast<double>(part));
  return {static_cast<float>(angle.cosine), static_cast<float>(angle.sine)};
}

}  // namespace raysheaf
