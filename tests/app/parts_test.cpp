// Parts of the command line that need no process: values, the progress line, tables.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "apps/support/console.h"
#include "apps/support/progress_bar.h"
#include "apps/support/table.h"
#include "apps/support/values.h"
#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

TEST(Values, SizesAreTwoWholeNumbersWithAnX) {
  EXPECT_EQ(parse_size("1x1"), (std::pair<std::uint32_t, std::uint32_t>(1, 1)));
  EXPECT_EQ(parse_size("640x480"), (std::pair<std::uint32_t, std::uint32_t>(640, 480)));
  EXPECT_EQ(parse_size("16384x16384").second, 16384u);
  for (const char* bad : {"", "x", "0x0", "0x5", "5x0", "5", "5x", "x5", "-5x5", "+5x5", "5x5x5",
                          "5 x5", "5x5 ", "16385x1", "99999999999x1", "4.5x4", "5X5", "axb"}) {
    EXPECT_THROW((void)parse_size(bad), Error) << bad;
  }
}

TEST(Values, CountsKeepTheirRange) {
  EXPECT_EQ(parse_count("2", 2, 64), 2u);
  EXPECT_EQ(parse_count("64", 2, 64), 64u);
  for (const char* bad : {"", "1", "65", "-3", "3.0", "3a", " 3", "4294967298"}) {
    EXPECT_THROW((void)parse_count(bad, 2, 64), Error) << bad;
  }
}

TEST(Values, ExposureIsAboveZeroAndFinite) {
  EXPECT_FLOAT_EQ(parse_positive("1.5"), 1.5f);
  EXPECT_FLOAT_EQ(parse_positive("1e-3"), 1e-3f);
  for (const char* bad : {"", "0", "-1", "nan", "inf", "1e99", "two"}) {
    EXPECT_THROW((void)parse_positive(bad), Error) << bad;
  }
}

TEST(Values, ColorsAreOneNumberOrThree) {
  const Vec3 grey = parse_color("0.25");
  EXPECT_FLOAT_EQ(grey.x, 0.25f);
  EXPECT_FLOAT_EQ(grey.z, 0.25f);
  const Vec3 color = parse_color("1,0,2.5");
  EXPECT_FLOAT_EQ(color.x, 1);
  EXPECT_FLOAT_EQ(color.y, 0);
  EXPECT_FLOAT_EQ(color.z, 2.5f);
  for (const char* bad : {"", ",", "1,2", "1,2,3,4", "1,,3", "1,2,-3", "1,2,nan", "red"}) {
    EXPECT_THROW((void)parse_color(bad), Error) << bad;
  }
}

TEST(Values, KeyBitsAndSwitchesTakeTheirWordsAlone) {
  EXPECT_EQ(parse_key_bits("32"), 32u);
  EXPECT_EQ(parse_key_bits("64"), 64u);
  EXPECT_TRUE(parse_switch("on"));
  EXPECT_FALSE(parse_switch("off"));
  for (const char* bad : {"", "16", "032", "64 ", "on", "yes"})
    EXPECT_THROW((void)parse_key_bits(bad), Error) << bad;
  for (const char* bad : {"", "On", "true", "1", "off "})
    EXPECT_THROW((void)parse_switch(bad), Error) << bad;
}

TEST(Values, EndingsInAnyCase) {
  EXPECT_TRUE(has_ending("a.PNG", ".png"));
  EXPECT_TRUE(has_ending(".png", ".png"));
  EXPECT_FALSE(has_ending("png", ".png"));
  EXPECT_FALSE(has_ending("a.png.txt", ".png"));
}

TEST(ProgressLine, FitsAndTellsAllFive) {
  const std::string line = progress_line("traverse", 1200, 2400, 2.0, 200);
  for (const char* part :
       {"traverse", "[############............]", "50 %", "1200 of 2400", "600/s", "2 s left"}) {
    EXPECT_NE(line.find(part), std::string::npos) << part << " in " << line;
  }
  for (std::size_t columns = 0; columns < 100; ++columns) {
    EXPECT_LE(progress_line("traverse", 1200, 2400, 2.0, columns).size(), columns);
  }
}

TEST(ProgressLine, AUsualTerminalShowsTheNumbersOfALongStage) {
  const std::string line =
      progress_line("refraction rays, bounce 12", 1'200'000, 240'000'000, 2.0, 79);
  EXPECT_NE(line.find("600 k/s  6 min 38 s left"), std::string::npos) << line;
}

TEST(ProgressLine, OddNumbersDoNotBreakIt) {
  const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
  EXPECT_NE(progress_line("a", 0, 0, 0, 80).find("0 %"), std::string::npos);
  EXPECT_NE(progress_line("a", 9, 3, 1, 80).find("100 %"), std::string::npos);
  EXPECT_FALSE(progress_line("a", 1, huge, 1e9, 80).empty());
  EXPECT_FALSE(progress_line("a", huge, huge, 0, 80).empty());
}

TEST(Table, ColumnsLineUp) {
  Table table({"item", "count", "name"});
  EXPECT_TRUE(table.empty());
  table.add({"a", "7", "short"});
  table.add({"bcd", "1234", "w\xc3\xbcrfel"});
  EXPECT_EQ(table.text(),
            "  item  count  name\n"
            "  a         7  short\n"
            "  bcd    1234  w\xc3\xbcrfel\n");
}

TEST(Console, NamesCannotSteerATerminal) {
  EXPECT_EQ(printable("a\x1b[31m\n\x7f"), "a?[31m??");
  EXPECT_EQ(printable("w\xc3\xbcrfel"), "w\xc3\xbcrfel");
}

}  // namespace
}  // namespace raysheaf::app
