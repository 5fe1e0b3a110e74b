// Compares the JSON tree with nlohmann-json's, and reads the written JSON back with both.
#include <bit>
#include <cmath>
#include <limits>

#include "io/json_value.h"
#include "io/json_writer.h"
#include "io_support.h"
#include "support/random.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

std::span<const std::uint8_t> json_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string random_text(Random& random) {
  constexpr const char* kParts[] = {"a", "Z", "\"", "\\", "\n", "\x01", "ß", "€", "😀", "/"};
  std::string text;
  for (std::uint32_t n = random.below(6); n > 0; --n) text += kParts[random.below(10)];
  return text;
}

Json random_value(Random& random, int depth) {
  switch (random.below(depth < 4 ? 9 : 7)) {
    case 0:
      return nullptr;
    case 1:
      return random.below(2) == 0;
    case 2:
      return static_cast<std::int64_t>(random.below(1000)) - 500;
    case 3:
      return std::uint64_t{random.below(0xffffffff)} << random.below(33);
    case 4:
      return -(std::int64_t{random.below(0xffffffff)} << random.below(32));
    case 5:
      return std::ldexp(static_cast<double>(random.between(-1, 1)),
                        static_cast<int>(random.below(600)) - 300);
    case 6:
      return random_text(random);
    case 7: {
      Json list = Json::array();
      for (std::uint32_t n = random.below(5); n > 0; --n)
        list.push_back(random_value(random, depth + 1));
      return list;
    }
    default: {
      Json object = Json::object();
      for (std::uint32_t n = random.below(5); n > 0; --n)
        object[random_text(random)] = random_value(random, depth + 1);
      return object;
    }
  }
}

/// Also if the number is written as 1.0 or 1e0.
bool is_whole(const Json& number) {
  if (!number.is_number_float()) return number.is_number_integer();
  const auto value = number.get<double>();
  return std::fabs(value) <= 0x1p53 && std::trunc(value) == value &&
         (value != 0 || !std::signbit(value));
}

void expect_same(const io::JsonValue& ours, const Json& theirs) {
  EXPECT_EQ(ours.is_null(), theirs.is_null());
  EXPECT_EQ(ours.is_boolean(), theirs.is_boolean());
  EXPECT_EQ(ours.is_integer(), is_whole(theirs));
  EXPECT_EQ(ours.is_number(), theirs.is_number());
  EXPECT_EQ(ours.is_string(), theirs.is_string());
  EXPECT_EQ(ours.is_array(), theirs.is_array());
  EXPECT_EQ(ours.is_object(), theirs.is_object());
  if (theirs.is_boolean()) {
    EXPECT_EQ(ours.get<bool>(), theirs.get<bool>());
  } else if (theirs.is_string()) {
    EXPECT_EQ(ours.get<std::string>(), theirs.get<std::string>());
  } else if (theirs.is_number()) {
    EXPECT_EQ(ours.get<double>(), theirs.get<double>());
  }
  if (theirs.is_number_integer()) {
    EXPECT_EQ(ours.digits(), theirs.dump());
  }
  ASSERT_EQ(ours.items().size(), theirs.is_array() ? theirs.size() : 0);
  ASSERT_EQ(ours.members().size(), theirs.is_object() ? theirs.size() : 0);
  for (std::size_t i = 0; i < ours.items().size(); ++i) expect_same(ours.items()[i], theirs[i]);
  auto member = ours.members().begin();
  for (auto it = theirs.begin(); theirs.is_object() && it != theirs.end(); ++it, ++member) {
    EXPECT_EQ(member->name, it.key());
    ASSERT_TRUE(ours.contains(it.key()));
    expect_same(*ours.find(it.key()), it.value());
  }
}

io::Json written_again(const io::JsonValue& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_string()) return value.get<std::string>();
  if (value.is_null()) return nullptr;
  if (value.is_integer() && value.digits()[0] == '-') return value.get<std::int64_t>();
  if (value.is_integer()) return value.get<std::uint64_t>();
  if (value.is_number()) return value.get<double>();
  io::JsonArray list;
  for (const io::JsonValue& item : value.items()) list.add(written_again(item));
  if (value.is_array()) return list;
  io::JsonObject object;
  for (const io::JsonMember& member : value.members())
    object.add(member.name, written_again(member.value));
  return object;
}

TEST(JsonTree, IsTheParsersOwn) {
  Random random(1);
  for (int round = 0; round < 3000; ++round) {
    const Json value = random_value(random, 0);
    const std::string text = value.dump(random.below(2) == 0 ? -1 : 2);
    const io::JsonDocument document(json_bytes(text));
    expect_same(document.root(), value);
    const std::string again = written_again(document.root()).text();
    EXPECT_EQ(Json::parse(again), value);
    if (HasFailure()) FAIL() << text << '\n' << again;
  }
}

TEST(JsonTree, WholeNumbersAreIntegersHoweverTheyAreWritten) {
  const std::string text = "[1.0, 1e0, -20e-1, 0.0, 9007199254740992.0, 1.5, -0.0, 1e300]";
  const io::JsonDocument document(
      {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const auto items = document.root().items();
  const char* digits[] = {"1", "1", "-2", "0", "9007199254740992"};
  for (std::size_t i = 0; i < std::size(digits); ++i) {
    ASSERT_TRUE(items[i].is_integer()) << i;
    EXPECT_EQ(items[i].digits(), digits[i]);
  }
  for (std::size_t i = std::size(digits); i < items.size(); ++i)
    EXPECT_FALSE(items[i].is_integer()) << i;
  EXPECT_TRUE(std::signbit(items[6].get<float>()));
}

TEST(JsonTree, RefusesWhatTheParserRefuses) {
  Random random(2);
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string text = random_value(random, 0).dump();
    text[random.below(static_cast<std::uint32_t>(text.size()))] =
        "\0\xff\"[]{},:e-.9\\ "[random.below(15)];
    const Json value = Json::parse(text, nullptr, false);
    try {
      const io::JsonDocument document(json_bytes(text));
      ASSERT_FALSE(value.is_discarded()) << text;
      expect_same(document.root(), value);
    } catch (const Error& error) {
      ASSERT_TRUE(value.is_discarded()) << text << error.what();
      EXPECT_EQ(error.place(), "JSON");
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(JsonTree, TheLastOfEqualNamesCounts) {
  std::string text = "{";
  for (int i = 0; i < 100000; ++i)
    text += "\"" + std::to_string(i * 7919 % 50000) + "\":" + std::to_string(i) + ",";
  text.back() = '}';
  const io::JsonDocument document(json_bytes(text));
  EXPECT_EQ(document.root().members().size(), 50000u);
  for (int i = 50000; i < 100000; ++i)
    ASSERT_EQ(document.root().at(std::to_string(i * 7919 % 50000)).get<int>(), i);
}

TEST(JsonTree, LimitsNesting) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_NO_THROW(io::JsonDocument{json_bytes(nested(64))});
  EXPECT_THROW(io::JsonDocument{json_bytes(nested(65))}, Error);
  EXPECT_THROW(io::JsonDocument{json_bytes(nested(100000))}, Error);
}

TEST(JsonTree, GivesNumbersThatFit) {
  const io::JsonDocument document(json_bytes(R"([-1,255,256,18446744073709551615,0.5,"x",-0])"));
  const auto list = document.root().items();
  EXPECT_EQ(list[1].get<std::uint8_t>(), 255);
  EXPECT_EQ(list[3].get<std::uint64_t>(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(list[4].get<float>(), 0.5f);
  EXPECT_EQ(list[6].get<std::size_t>(), 0u);
  EXPECT_THROW(static_cast<void>(list[0].get<std::uint32_t>()), io::JsonMismatch);
  EXPECT_THROW(static_cast<void>(list[2].get<std::uint8_t>()), io::JsonMismatch);
  EXPECT_THROW(static_cast<void>(list[3].get<std::int64_t>()), io::JsonMismatch);
  EXPECT_THROW(static_cast<void>(list[4].get<int>()), io::JsonMismatch);
  EXPECT_THROW(static_cast<void>(list[5].get<double>()), io::JsonMismatch);
  EXPECT_THROW(static_cast<void>(list[5].at("x")), io::JsonMismatch);
  EXPECT_THROW(static_cast<void>(document.root().at(7)), io::JsonMismatch);
  EXPECT_EQ(list[5].get("x", 3), 3);
}

/// Names may hold any bytes: written text can be read back, and valid UTF-8 stays unchanged.
TEST(JsonText, AnyBytes) {
  Random random(3);
  for (int round = 0; round < 20000; ++round) {
    std::string text;
    for (std::uint32_t n = random.below(6); n > 0; --n)
      text +=
          static_cast<char>(random.below(2) == 0 ? random.below(256) : 0x80 + random.below(0x50));
    const std::string strict = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::string back = Json::parse(io::json_text(text)).get<std::string>();
    const bool valid = Json::parse(strict).get<std::string>() == text;
    EXPECT_EQ(back == text, valid) << strict;
  }
}

TEST(JsonText, NumbersReadBack) {
  Random random(4);
  for (int round = 0; round < 20000; ++round) {
    const float x = std::bit_cast<float>(random.bits());
    const std::string text = io::Json(x).text();
    if (std::isfinite(x)) {
      EXPECT_EQ(Json::parse(text).get<float>(), x) << text;
    } else {
      EXPECT_EQ(text, "null");
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
