#include "tests/bits/checksums.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "raysheaf/io.h"

namespace raysheaf::test {
namespace {

std::string golden_path() {
  return std::string(RAYSHEAF_SOURCE_DIR) + "/tests/golden/bits.txt";
}

/// Lines "CHECKSUM NAME"; a line that begins with # is a comment.
std::map<std::string, std::string> read_golden() {
  std::map<std::string, std::string> all;
  std::ifstream file(golden_path());
  for (std::string line; std::getline(file, line);) {
    if (const auto gap = line.find(' '); !line.starts_with('#') && gap != std::string::npos)
      all[line.substr(gap + 1)] = line.substr(0, gap);
  }
  return all;
}

void write_golden(const std::map<std::string, std::string>& all) {
  std::string text =
      "# Checksums that every machine must get: tests/bits. RAYSHEAF_UPDATE_GOLDEN=1 test_bits\n"
      "# writes them again.\n";
  for (const auto& [name, sum] : all) text += sum + " " + name + "\n";
  write_text(text, golden_path());
}

}  // namespace

void Checksum::add(float x) {
  add(x == x ? std::bit_cast<std::uint32_t>(x) : 0x7fc00000u);
}

void Checksum::add(double x) {
  add(x == x ? std::bit_cast<std::uint64_t>(x) : 0x7ff8000000000000u);
}

void Checksum::add(std::string_view text) {
  add(static_cast<std::uint64_t>(text.size()));
  for (const char c : text) add_byte(static_cast<std::uint8_t>(c));
}

std::string Checksum::text() const {
  std::string digits(16, '0');
  for (std::size_t i = 0; i < 16; ++i) digits[i] = "0123456789abcdef"[sum_ >> (60 - 4 * i) & 15];
  return digits;
}

void expect_bits(const std::string& name, const Checksum& sum) {
  std::map<std::string, std::string> golden = read_golden();
  if (std::getenv("RAYSHEAF_UPDATE_GOLDEN") != nullptr) {
    golden[name] = sum.text();
    return write_golden(golden);
  }
  const auto found = golden.find(name);
  ASSERT_NE(found, golden.end()) << name << " is not in tests/golden/bits.txt";
  EXPECT_EQ(sum.text(), found->second) << name;
}

namespace {

TEST(Checksum, DependsOnEveryBitButOnNoNan) {
  EXPECT_NE(checksum_of(0.0f).text(), checksum_of(-0.0f).text());
  EXPECT_NE(checksum_of(1.0f).text(), checksum_of(1.0).text());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(checksum_of(nan).text(), checksum_of(-nan).text());
  EXPECT_NE(checksum_of(std::vector{1, 2}).text(), checksum_of(std::vector{2, 1}).text());
  EXPECT_EQ(checksum_of(std::uint8_t{'a'}).text(), "af63dc4c8601ec8c");  // as FNV-1a is published
}

}  // namespace
}  // namespace raysheaf::test
