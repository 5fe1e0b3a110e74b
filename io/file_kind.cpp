#include "io/file_kind.h"

#include <algorithm>
#include <string_view>

namespace raysheaf::io {
namespace {

using namespace std::string_view_literals;

constexpr const char* kByBlender = "convert it to glTF, for instance with Blender";
constexpr const char* kByAny = "convert it to glTF, for instance with Blender or assimp";
constexpr const char* kByFreeCad = "convert it to glTF, for instance with FreeCAD";
constexpr const char* kByItsProgram = "export glTF from the program that it belongs to";
constexpr const char* kPoints = "it holds points, and raysheaf renders triangles";
constexpr const char* kUnpack = "unpack it first";

/// The first bytes of a file kind.
struct Magic {
  std::string_view bytes;
  FileKind kind;
};
constexpr Magic kMagics[] = {
    {"glTF"sv, {"a binary glTF file", "give it a name that ends in .glb"}},
    {"ply\n"sv, {"a PLY file", "give it a name that ends in .ply"}},
    {"ply\r"sv, {"a PLY file", "give it a name that ends in .ply"}},
    {"solid"sv, {"an STL file", "give it a name that ends in .stl"}},
    {"Kaydara FBX"sv, {"an FBX file", kByAny}},
    {"; FBX"sv, {"an FBX file", kByAny}},
    {"BLENDER"sv, {"a Blender file", "export glTF from Blender"}},
    {"#usda"sv, {"a USD file", kByBlender}},
    {"PXR-USDC"sv, {"a USD file", kByBlender}},
    {"ISO-10303-21"sv, {"a STEP file", kByFreeCad}},
    {"Ogawa"sv, {"an Alembic file", kByBlender}},
    {"#VRML"sv, {"a VRML file", kByAny}},
    {"#X3D"sv, {"an X3D file", kByAny}},
    {"xof 0"sv, {"a DirectX file", "convert it to glTF, for instance with assimp"}},
    {"OFF\n"sv, {"an OFF file", "convert it to PLY, for instance with assimp"}},
    {"OFF\r"sv, {"an OFF file", "convert it to PLY, for instance with assimp"}},
    {"OFF "sv, {"an OFF file", "convert it to PLY, for instance with assimp"}},
    {"COFF"sv, {"an OFF file", "convert it to PLY, for instance with assimp"}},
    {"DRACO"sv, {"a Draco mesh without glTF", "convert it to PLY with draco_decoder"}},
    {"# vtk DataFile"sv, {"a VTK file", "convert it to PLY, for instance with ParaView"}},
    {"# .PCD"sv, {"a PCD file", kPoints}},
    {"LASF"sv, {"a LAS file", kPoints}},
    {"\x89PNG"sv, {"a PNG image", ""}},
    {"\xff\xd8\xff"sv, {"a JPEG image", ""}},
    {"II*\0"sv, {"a TIFF image", ""}},
    {"MM\0*"sv, {"a TIFF image", ""}},
    {"II+\0"sv, {"a TIFF image", ""}},
    {"MM\0+"sv, {"a TIFF image", ""}},
    {"GIF8"sv, {"a GIF image", ""}},
    {"8BPS"sv, {"a Photoshop image", ""}},
    {"DDS "sv, {"a DDS texture", ""}},
    {"\xabKTX"sv, {"a KTX texture", ""}},
    {"sB\x13\0"sv, {"a Basis texture", ""}},
    {"#?RADIANCE"sv, {"a Radiance HDR image", ""}},
    {"#?RGBE"sv, {"a Radiance HDR image", ""}},
    {"v/1\x01"sv, {"an EXR image", ""}},
    {"\0\0\0\x0cjP  "sv, {"a JPEG 2000 image", ""}},
    {"\0\0\0\x0cJXL "sv, {"a JPEG XL image", ""}},
    {"\xff\x0a"sv, {"a JPEG XL image", ""}},
    {"qoif"sv, {"a QOI image", ""}},
    {"PK\x03\x04"sv, {"a ZIP archive", kUnpack, true}},
    {"\x1f\x8b"sv, {"a gzip file", kUnpack}},
    {"\x28\xb5\x2f\xfd"sv, {"a Zstandard file", kUnpack}},
    {"7z\xbc\xaf\x27\x1c"sv, {"a 7-Zip archive", kUnpack}},
    {"Rar!"sv, {"a RAR archive", kUnpack}},
    {"BZh"sv, {"a bzip2 file", kUnpack}},
    {"\xfd"
     "7zXZ"sv,
     {"an xz file", kUnpack}},
    {"\x89HDF"sv, {"an HDF5 file", "", true}},
    {"RIFF"sv, {"a RIFF file, such as a WebP image", "", true}},
    {"%PDF"sv, {"a PDF document", ""}},
    {"\x7f"
     "ELF"sv,
     {"a program", ""}},
    {"version https://git-lfs"sv,
     {"a Git LFS pointer", "fetch the file itself with `git lfs pull`"}},
    {"<"sv, {"XML or HTML", "", true}},
    {"\0\0\0\0"sv, {"zeros", "it was not written to its end", true}}};

/// Kinds of XML files, by a tag among their first bytes.
constexpr Magic kTags[] = {
    {"<COLLADA"sv, {"a COLLADA file", kByAny}},
    {"<X3D"sv, {"an X3D file", kByAny}},
    {"<amf"sv, {"an AMF file", kByAny}},
    {"<VTKFile"sv, {"a VTK file", "convert it to PLY, for instance with ParaView"}},
    {"<svg"sv, {"an SVG image", ""}},
    {"<html"sv, {"a web page", "download the file itself"}},
    {"<!DOCTYPE html"sv, {"a web page", "download the file itself"}}};

/// The extensions of a kind, with a blank before and after each.
constexpr Magic kEndings[] = {
    {" fbx "sv, {"an FBX file", kByAny}},
    {" dae "sv, {"a COLLADA file", kByAny}},
    {" usd usda usdc usdz "sv, {"a USD file", kByBlender}},
    {" 3mf "sv, {"a 3MF file", "convert it to STL, for instance with PrusaSlicer or assimp"}},
    {" amf "sv, {"an AMF file", kByAny}},
    {" blend "sv, {"a Blender file", "export glTF from Blender"}},
    {" stp step p21 stpz "sv, {"a STEP file", kByFreeCad}},
    {" igs iges "sv, {"an IGES file", kByFreeCad}},
    {" brep brp fcstd "sv, {"a CAD file", kByFreeCad}},
    {" abc "sv, {"an Alembic file", kByBlender}},
    {" 3ds "sv, {"a 3D Studio file", kByAny}},
    {" max "sv, {"a 3ds Max file", kByItsProgram}},
    {" ma mb "sv, {"a Maya file", kByItsProgram}},
    {" c4d "sv, {"a Cinema 4D file", kByItsProgram}},
    {" skp "sv, {"a SketchUp file", kByItsProgram}},
    {" 3dm "sv, {"a Rhinoceros file", kByItsProgram}},
    {" sldprt sldasm "sv, {"a SolidWorks file", kByItsProgram}},
    {" dwg dxf "sv, {"an AutoCAD file", kByItsProgram}},
    {" ifc "sv, {"an IFC file", "convert it to glTF, for instance with IfcConvert"}},
    {" lwo lws lxo "sv, {"a LightWave or Modo file", kByAny}},
    {" x3d x3db x3dv "sv, {"an X3D file", kByAny}},
    {" wrl vrml "sv, {"a VRML file", kByAny}},
    {" x "sv, {"a DirectX file", "convert it to glTF, for instance with assimp"}},
    {" off coff noff "sv, {"an OFF file", "convert it to PLY, for instance with assimp"}},
    {" ac ase b3d bvh cob irr mdl md2 md3 md5mesh ms3d nff ogex smd "sv,
     {"a file of a 3D format that is not read", "convert it to glTF, for instance with assimp"}},
    {" drc "sv, {"a Draco mesh without glTF", "convert it to PLY with draco_decoder"}},
    {" vrm "sv, {"a VRM file", "give it a name that ends in .glb"}},
    {" vtk vtp vtu msh "sv,
     {"a mesh of a simulation", "convert it to PLY, for instance with ParaView or meshio"}},
    {" pcd las laz xyz pts e57 splat spz ksplat "sv, {"a file of points", kPoints}},
    {" zip gz zst 7z rar bz2 xz tar tgz "sv, {"an archive", kUnpack}},
    {" png jpg jpeg webp tga bmp exr hdr tif tiff gif "sv, {"an image", "a scene is needed"}}};

bool begins_with_bytes(std::span<const std::uint8_t> head, std::string_view bytes) {
  return head.size() >= bytes.size() &&
         std::equal(bytes.begin(), bytes.end(), head.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

}  // namespace

const FileKind* kind_by_content(std::span<const std::uint8_t> head) {
  head = head.first(std::min(head.size(), kKindBytes));
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  const auto text = begins_with_bytes(head, kMark) ? head.subspan(kMark.size()) : head;
  for (const Magic& magic : kMagics) {
    if (!begins_with_bytes(text, magic.bytes)) continue;
    if (magic.bytes != "<") return &magic.kind;
    for (const Magic& tag : kTags) {
      if (std::search(text.begin(), text.end(), tag.bytes.begin(), tag.bytes.end()) != text.end())
        return &tag.kind;
    }
    return &magic.kind;
  }
  return nullptr;
}

const FileKind* kind_by_ending(const std::string& ending) {
  const std::string wanted = " " + ending + " ";
  for (const Magic& known : kEndings)
    if (!ending.empty() && known.bytes.find(wanted) != known.bytes.npos) return &known.kind;
  return nullptr;
}

const FileKind* kind_of(std::span<const std::uint8_t> head, const std::string& ending) {
  const FileKind* by_content = kind_by_content(head);
  if (by_content != nullptr && !by_content->is_container) return by_content;
  const FileKind* by_ending = kind_by_ending(ending);
  return by_ending != nullptr ? by_ending : by_content;
}

std::string described(const FileKind& kind) {
  const std::string advice = kind.advice;
  return kind.name + (advice.empty() ? "" : "; " + advice);
}

}  // namespace raysheaf::io
