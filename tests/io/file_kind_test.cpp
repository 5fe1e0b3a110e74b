// Files in formats that raysheaf does not read, or with a wrong extension, give a helpful error.
#include "io/file_kind.h"

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using enum ErrorCode;
using FileKinds = IoTest;
using namespace std::string_literals;

TEST_F(FileKinds, AreNamedByExtensionWithAdvice) {
  struct Case {
    const char* name;
    std::vector<std::string> words;
  };
  for (const Case& one :
       std::vector<Case>{{"a.fbx", {"is an FBX file", "convert it to glTF", "Blender or assimp"}},
                         {"a.DAE", {"is a COLLADA file", "assimp"}},
                         {"a.usdz", {"is a USD file", "Blender"}},
                         {"a.3mf", {"is a 3MF file", "convert"}},
                         {"a.blend", {"is a Blender file", "export glTF"}},
                         {"a.stp", {"is a STEP file", "FreeCAD"}},
                         {"a.step", {"is a STEP file", "FreeCAD"}},
                         {"a.igs", {"is an IGES file", "FreeCAD"}},
                         {"a.abc", {"is an Alembic file", "Blender"}},
                         {"a.3ds", {"is a 3D Studio file", "assimp"}},
                         {"a.x3d", {"is an X3D file", "assimp"}},
                         {"a.off", {"is an OFF file", "convert it to PLY"}},
                         {"a.e57", {"points"}},
                         {"a.png", {"is an image"}},
                         {"a.xyzzy", {"the ending is none of", ".glb"}},
                         {"a", {"the ending is none of"}}})
    expect_refused(write(one.name, "1 2 3\n"s), kUnsupported, one.words);
}

TEST_F(FileKinds, AreNamedByContentWhateverTheEnding) {
  struct Case {
    std::string bytes;
    std::vector<std::string> words;
  };
  const std::vector<Case> cases = {
      {"Kaydara FBX Binary  \0\x1a\0"s, {"an FBX file", "Blender or assimp"}},
      {"; FBX 7.4.0 project file\n", {"an FBX file"}},
      {"BLENDER-v300", {"a Blender file"}},
      {"#usda 1.0\n", {"a USD file"}},
      {"PXR-USDC\0"s, {"a USD file"}},
      {"ISO-10303-21;\n", {"a STEP file"}},
      {"<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"\">", {"a COLLADA file"}},
      {"\xef\xbb\xbf<?xml version=\"1.0\"?><X3D>", {"an X3D file"}},
      {"<!DOCTYPE html><html>", {"a web page", "download"}},
      {"OFF\n3 1 0\n", {"an OFF file"}},
      {"version https://git-lfs.github.com/spec/v1\n", {"a Git LFS pointer", "git lfs pull"}},
      {"II*\0"s, {"a TIFF image"}}};
  for (const Case& one : cases) {
    expect_refused(write("a.model", one.bytes), kUnsupported, one.words);
    expect_refused(write("a.fbx", one.bytes), kUnsupported, one.words);
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"}) {
      expect_refused(write(name, one.bytes), kInvalidData, one.words);
      expect_refused(path(name), kInvalidData, {"is not "});
    }
  }
}

/// An archive may be a model: its extension tells the format.
TEST_F(FileKinds, OfContainersAreNamedByTheirEnding) {
  expect_refused(write("a.3mf", "PK\x03\x04"s), kUnsupported, {"a 3MF file"});
  expect_refused(write("a.usdz", "PK\x03\x04"s), kUnsupported, {"a USD file"});
  expect_refused(write("a.model", "PK\x03\x04"s), kUnsupported, {"a ZIP archive", "unpack"});
  expect_refused(write("a.obj", "PK\x03\x04"s), kInvalidData, {"is not OBJ", "a ZIP archive"});
}

TEST_F(FileKinds, WithAWrongExtensionNameTheRightOne) {
  expect_refused(write("a.mesh", "ply\nformat ascii 1.0\n"s), kUnsupported, {"PLY", ".ply"});
  expect_refused(write("a.obj", "ply\nformat ascii 1.0\n"s), kInvalidData, {"PLY", ".ply"});
  expect_refused(write("a.ply", "solid a\n"s), kInvalidData, {"is not PLY", "STL", ".stl"});
  expect_refused(write("a.vrm", "glTF\2\0\0\0"s), kUnsupported, {"binary glTF", ".glb"});
  expect_refused(write("a.stl", "ply\nformat ascii 1.0\n"s), kInvalidData, {"is not STL", ".ply"});
}

/// The header of a binary STL may hold any text.
TEST_F(FileKinds, OfBinaryStlFollowFromItsLength) {
  for (const std::string& head : {"BLENDER"s, "<made by hand>"s, "PK\x03\x04"s, "\0\0\0\0"s}) {
    Bytes bytes(head.begin(), head.end());
    bytes.resize(80, ' ');
    append(bytes, std::uint32_t{1});
    for (const float x : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
      append(bytes, x);
    append(bytes, std::uint16_t{0});
    EXPECT_EQ(load_scene(write("a.stl", bytes)).triangle_count(), 1u);
  }
}

}  // namespace
}  // namespace raysheaf::test
