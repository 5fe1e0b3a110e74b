// Scripts: errors are reported before anything runs, with file and line.
#include "script.h"

#include <gtest/gtest.h>

#include "raysheaf/error.h"
#include "tests/support/process.h"
#include "view_settings.h"

namespace raysheaf::viewer {
namespace {

TEST(Script, IsWordsOnLines) {
  const Script script =
      parse_script("# a tour\n\n  method crsh  # trailing\norbit 30 -10\ndrop \"a b.glb\"\n", "t");
  ASSERT_EQ(script.commands.size(), 3u);
  EXPECT_EQ(script.commands[0].line, 3);
  EXPECT_EQ(script.commands[1].words, (std::vector<std::string>{"orbit", "30", "-10"}));
  EXPECT_EQ(script.commands[2].words[1], "a b.glb");
  EXPECT_EQ(script.place(script.commands[1]), "t:4");
}

TEST(Script, ErrorsNameFileAndLine) {
  for (const auto& [text, said] : std::vector<std::pair<std::string, std::string>>{
           {"orbit 1 2\njump\n", "t:2: 'jump' is neither a setting nor one of orbit, look"},
           {"orbit 1\n", "t:1: 'orbit' takes: YAW PITCH"},
           {"quit now\n", "t:1: 'quit' takes nothing"},
           {"orbit a 2\n", "t:1: 'a' is not a number"},
           {"orbit nan 2\n", "t:1: 'nan' is not a number"},
           {"wait inf\n", "t:1: 'inf' is not a number"},
           {"zoom 1e300\n", "t:1: '1e300' is not a number"},
           {"levels 99\n", "t:1: levels must be a number from 1 to 8"},
           {"method\n", "t:1: 'method' takes one value"},
           {"assert rays ~ 5\n", "t:1: '~' is none of <, <=, >, >=, is, is-not, contains"},
           {"drop \"open\n", "t:1: a quotation mark is not closed"}}) {
    try {
      (void)parse_script(text, "t");
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, said.size()), said);
    }
  }
  EXPECT_THROW((void)load_script("/nowhere/at/all"), Error);
  EXPECT_THROW((void)load_script("/"), Error);
}

TEST(Script, ThePageDescribesEveryCommandAndSetting) {
  const std::string page = test::read_file(RAYSHEAF_SOURCE_DIR "/docs/viewer.md");
  for (const ScriptVerb& verb : script_verbs()) {
    const std::string span =
        "`" + verb.name + (verb.arguments.empty() ? "" : " " + verb.arguments) + "`";
    EXPECT_NE(page.find(span), std::string::npos) << span;
  }
  for (const SettingField& field : setting_fields()) {
    if (field.name.starts_with("right-")) continue;
    EXPECT_NE(page.find("`" + field.name + "`"), std::string::npos) << field.name;
  }
}

}  // namespace
}  // namespace raysheaf::viewer
