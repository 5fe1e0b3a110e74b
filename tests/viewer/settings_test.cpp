// Settings: each is saved and restored; an invalid file changes nothing.
#include <gtest/gtest.h>

#include "display.h"
#include "raysheaf/error.h"
#include "settings_file.h"
#include "tests/support/process.h"

namespace raysheaf::viewer {
namespace {

using test::TemporaryFolder;
using test::write_file;

/// A value that differs from the field's default.
std::string other_value(const SettingField& field) {
  const std::string now = field.get({});
  for (const std::string& word : field.words)
    if (word != now) return word;
  for (const char* number : {"3", "0.375", "640"}) {
    ViewSettings scratch;
    try {
      field.set(scratch, number);
    } catch (const Error&) {
      continue;
    }
    if (field.get(scratch) != now) return number;
  }
  return now;
}

TEST(Settings, EveryOneIsRemembered) {
  const TemporaryFolder folder;
  const std::string path = folder.file("deep/raysheaf/view");
  ViewSettings all;
  for (const SettingField& field : setting_fields()) {
    const ViewSettings before = all;
    field.set(all, other_value(field));
    EXPECT_NE(all, before) << field.name;
    EXPECT_FALSE(field.what.empty());
  }
  save_settings(all, path);
  const LoadedSettings loaded = load_settings(path);
  EXPECT_EQ(loaded.sentence, "");
  EXPECT_EQ(loaded.settings, all);
}

TEST(Settings, ABrokenFileIsIgnoredWithASentence) {
  const TemporaryFolder folder;
  const std::string path = folder.file("view");
  for (const auto& [text, said] : std::vector<std::pair<std::string, std::string>>{
           {"method rah\nlevels 99\n", ":2: levels must be a number from 1 to 8"},
           {"method rah\nnonsense 1\n", ":2: 'nonsense' is not a setting"},
           {"method\n", ":1: 'method' takes one value"},
           {"method rah crsh\n", ":1: 'method' takes one value"},
           {"method fast\n", ":1: method 'fast' is none of brute, rah"},
           {"bounces 1.5\n", ":1: bounces must be a whole number"},
           {"exposure nan\n", "exposure must be a number"},
           {"\xff\x01", "is not a setting"}}) {
    write_file(path, text);
    const LoadedSettings loaded = load_settings(path);
    EXPECT_EQ(loaded.settings, ViewSettings()) << text;
    EXPECT_NE(loaded.sentence.find(said), std::string::npos) << loaded.sentence;
    EXPECT_NE(loaded.sentence.find(path), std::string::npos) << loaded.sentence;
  }
  write_file(path, std::string(1 << 20, '#'));
  EXPECT_NE(load_settings(path).sentence, "");
  EXPECT_NE(load_settings(folder.path().string()).sentence, "");
  EXPECT_EQ(load_settings(folder.file("none")).sentence, "");
}

TEST(Settings, LieWhereXdgSays) {
  const test::ScopedVariable home("HOME", "/home/someone");
  {
    const test::ScopedVariable config("XDG_CONFIG_HOME", "/elsewhere");
    EXPECT_EQ(default_settings_path(), "/elsewhere/raysheaf/view");
  }
  for (const char* useless : {"", "not/absolute"}) {
    const test::ScopedVariable config("XDG_CONFIG_HOME", useless);
    EXPECT_EQ(default_settings_path(), "/home/someone/.config/raysheaf/view");
  }
}

TEST(Settings, SayWhichPicturesAreTheSame) {
  const ViewSettings a;
  ViewSettings b = a;
  b.panel = !b.panel;
  b.divider = 0.1f;
  b.right.levels = 5;  // not shown without a split
  EXPECT_TRUE(same_picture(a, b));
  b.left.levels = 5;
  EXPECT_FALSE(same_picture(a, b));
  b = a;
  b.layer = Layer::kTests;
  EXPECT_FALSE(same_picture(a, b));
}

}  // namespace
}  // namespace raysheaf::viewer
