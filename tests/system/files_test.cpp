// Files of the system, as src/system/files.h promises them on every system.
#include "system/files.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <set>

#include "support/folder.h"
#include "system/paths.h"

namespace raysheaf::test {
namespace {

using system::Access;
using Kind = system::FileState::Kind;
using Bytes = std::vector<std::uint8_t>;

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  system::for_each_name(folder, [&names](const char* name) { names.insert(name); });
  names.erase("."), names.erase("..");
  return names;
}

Bytes read_all(int file) {
  Bytes bytes(100);
  std::int64_t got = 1;
  std::uint64_t size = 0;
  while ((got = system::read_some(file, size, std::span(bytes).subspan(size))) > 0)
    size += static_cast<std::uint64_t>(got);
  EXPECT_EQ(got, 0);
  bytes.resize(size);
  return bytes;
}

class Files : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string all() const { return folder_.file(""); }
  /// A file with these bytes.
  void make(const std::string& name, const Bytes& bytes) const {
    const int file = system::make_file(path(name));
    ASSERT_GE(file, 0);
    EXPECT_EQ(system::write_some(file, 0, bytes), static_cast<std::int64_t>(bytes.size()));
    EXPECT_TRUE(system::close_file(file));
  }
  [[nodiscard]] Bytes content(const std::string& name) const {
    const int file = system::open_file(path(name), Access::kRead);
    EXPECT_GE(file, 0);
    const Bytes bytes = read_all(file);
    EXPECT_TRUE(system::close_file(file));
    return bytes;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Files, AreWrittenAndReadAtAnyPlace) {
  const int file = system::open_or_make_file(path("a"));
  ASSERT_GE(file, 0);
  EXPECT_EQ(system::write_some(file, 3, Bytes{4, 5}), 2);
  EXPECT_EQ(system::write_some(file, 0, Bytes{1, 2, 3}), 3);
  EXPECT_EQ(read_all(file), (Bytes{1, 2, 3, 4, 5}));
  EXPECT_TRUE(system::resize_file(file, 2));
  EXPECT_EQ(read_all(file), (Bytes{1, 2}));
  EXPECT_TRUE(system::close_file(file));
  EXPECT_EQ(content("a"), (Bytes{1, 2}));
}

TEST_F(Files, FailWithTheirReason) {
  EXPECT_EQ(system::open_file(path("none"), Access::kRead), -1);
  EXPECT_EQ(errno, ENOENT);
  EXPECT_EQ(system::state_of(path("none/b")), std::nullopt);
  make("taken", {});
  EXPECT_EQ(system::make_file(path("taken")), -1);
  EXPECT_EQ(errno, EEXIST);
  EXPECT_FALSE(system::can_make_files_in(path("none")));
  EXPECT_EQ(errno, ENOENT);
  EXPECT_TRUE(system::can_make_files_in(all()));
  EXPECT_TRUE(names_in(path("none")).empty());
}

TEST_F(Files, HaveAState) {
  make("a", {1, 2, 3});
  const auto state = system::state_of(path("a"));
  ASSERT_TRUE(state);
  EXPECT_EQ(state->kind, Kind::kRegular);
  EXPECT_EQ(state->bytes, 3u);
  make("b", {});
  const auto other = system::state_of(path("b"));
  EXPECT_NE(state->number, other->number);
  EXPECT_EQ(state->volume, other->volume);
  EXPECT_EQ(system::state_of(all())->kind, Kind::kFolder);
  const int file = system::open_file(path("a"), Access::kUpdate);
  EXPECT_EQ(system::state_of(file)->number, state->number);
  EXPECT_EQ(system::write_some(file, 0, Bytes{9}), 1);
  EXPECT_GE(system::state_of(file)->written_ns, state->written_ns);
  EXPECT_TRUE(system::close_file(file));
}

TEST_F(Files, AreReplacedByRenaming) {
  make("old", {1});
  make("new", {2, 3});
  EXPECT_TRUE(system::replace_file(path("new"), path("old")));
  EXPECT_EQ(content("old"), (Bytes{2, 3}));
  EXPECT_EQ(names_in(all()), (std::set<std::string>{"old"}));
  EXPECT_TRUE(system::remove_file(path("old")));
  EXPECT_FALSE(system::remove_file(path("old")));
}

TEST_F(Files, WithoutANameGetOneOrDisappear) {
  for (const bool is_kept : {false, true}) {
    const int file = system::make_file_without_name(all());
    if (file < 0) GTEST_SKIP() << "there are no such files here";
    EXPECT_TRUE(names_in(all()).empty());
    EXPECT_EQ(system::write_some(file, 0, Bytes{7}), 1);
    if (is_kept) {
      EXPECT_TRUE(system::give_name(file, path("named")));
      EXPECT_FALSE(system::give_name(file, path("named")));
    }
    EXPECT_TRUE(system::close_file(file));
  }
  EXPECT_EQ(content("named"), Bytes{7});
}

TEST_F(Files, ForScratchDisappear) {
  const int file = system::make_scratch_file(path("scratch"));
  ASSERT_GE(file, 0);
  EXPECT_EQ(system::write_some(file, 0, Bytes{1, 2}), 2);
  EXPECT_EQ(read_all(file), (Bytes{1, 2}));
  EXPECT_TRUE(system::close_file(file));
  EXPECT_TRUE(names_in(all()).empty());
}

TEST_F(Files, HaveNamesInEveryScript) {
  const std::string name = "\xc3\xa4 \xe6\x97\xa5\xf0\x9f\x8c\x8d.obj";
  EXPECT_EQ(system::text_of(system::path_of(name)), name);
  make(name, {1});
  EXPECT_EQ(names_in(all()), std::set<std::string>{name});
  EXPECT_EQ(content(name), Bytes{1});
}

TEST(Paths, WhoseNamesAreSpecialAreKnown) {
  constexpr bool kIsWindows = std::filesystem::path::preferred_separator == '\\';
  for (const char* name :
       {"aux.png", "a/COM1", "con", "nul.tar.gz", "LPT\xc2\xb9.obj", "a./b", "a "})
    EXPECT_EQ(system::has_special_name(system::path_of(name)), kIsWindows) << name;
  for (const char* name : {"", ".", "../a/..", "auxiliary.png", "com10", "com", " a", "a.b/c.d"})
    EXPECT_FALSE(system::has_special_name(system::path_of(name))) << name;
}

}  // namespace
}  // namespace raysheaf::test
