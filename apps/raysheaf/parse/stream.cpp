#include "parse/stream.h"

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {
namespace {

Share share_from_string(const std::string& text) {
  if (text == "auto") return Share::kAuto;
  if (text == "rays") return Share::kRays;
  if (text == "geometry") return Share::kGeometry;
  if (text == "none") return Share::kNone;
  throw Error(ErrorCode::kInvalidArgument,
              "'" + text + "' is neither auto nor rays nor geometry nor none");
}

}  // namespace

CLI::App* add_scene(CLI::App& app, SceneCommand& command) {
  CLI::App* sub = app.add_subcommand("scene", "Write a built-in scene to a file");
  sub->add_option("NAME", command.name,
                  "A name that --list prints, or hall: a generated hall of --triangles");
  sub->add_option("-o,--output", command.output, "The file: binary glTF, or blocks")
      ->type_name("FILE.glb|FILE.rsb");
  sub->add_flag("--list", command.list, "Print the names of the built-in scenes");
  add_value(*sub, "--triangles", "N",
            "Most triangles of the hall, also with K, M or G (powers of 1000) [1M]",
            [&command](const auto& text) { command.triangles = parse_amount(text); });
  sub->add_flag("--compress", command.compress, "Compress blocks with Zstandard");
  add_threads(*sub, command.threads);
  sub->footer(
      "Examples:\n"
      "  raysheaf scene --list\n"
      "  raysheaf scene office -o office.glb\n"
      "  raysheaf scene hall --triangles 100M -o hall.rsb");
  sub->callback([sub, &command] {
    if (command.list) return;
    if (command.name.empty()) throw CLI::ValidationError("scene", "give a NAME or --list");
    if (command.output.empty()) throw CLI::ValidationError("scene", "give -o FILE.glb");
    if (!has_ending(command.output, ".glb") && !has_ending(command.output, ".rsb"))
      throw CLI::ValidationError("-o", "'" + command.output + "' ends neither in .glb nor in .rsb");
    if (command.name != "hall" && sub->get_option("--triangles")->count() > 0)
      throw CLI::ValidationError("--triangles",
                                 "it is only for the hall: the other scenes have a fixed size");
    if (command.compress && has_ending(command.output, ".glb"))
      throw CLI::ValidationError("--compress", "it is only for block files: give -o FILE.rsb");
  });
  return sub;
}

CLI::App* add_pack(CLI::App& app, PackCommand& command) {
  CLI::App* sub = app.add_subcommand("pack", "Cut a scene into blocks that can be streamed");
  add_scene_file(*sub, command.scene, command.load, {.blocks = true});
  sub->add_option("-o,--output", command.output, "The block file")
      ->type_name("FILE.rsb")
      ->required();
  sub->add_flag("--compress", command.file.compress, "Compress blocks with Zstandard");
  add_count(*sub, "--block-triangles", command.block_triangles, 1, kBlockTriangles,
            "Most triangles of a block, 1 to 65536 [65536]");
  add_quiet(*sub, command.quiet, "Show no warnings or summary");
  sub->footer(
      "Examples:\n"
      "  raysheaf pack model.glb -o model.rsb\n"
      "  raysheaf render model.rsb --memory 1G -o model.png");
  sub->callback([&command] {
    if (!has_ending(command.output, ".rsb"))
      throw CLI::ValidationError("-o", "'" + command.output + "' does not end in .rsb");
    if (has_ending(command.scene, ".rsb") && command.block_triangles != kBlockTriangles)
      throw CLI::ValidationError(
          "--block-triangles",
          "the blocks of a .rsb file keep their size: pack the file that it was made from");
  });
  return sub;
}

void add_streaming(CLI::App& app, RenderCommand& command) {
  begin_group(app, kStreamingGroup);
  app.add_flag("--stream", command.stream,
               "Stream the triangles past the rays in blocks, as .rsb files always do");
  add_value(app, "--memory", "SIZE",
            "Memory for a streamed frame: bytes, or with K, M or G (powers of 1024) [2G]",
            [&command](const auto& text) { command.memory_bytes = parse_bytes(text); });
  begin_group(app, kProcessesGroup);
  add_value(app, "--share", "auto|rays|geometry|none",
            "How the processes of mpirun share the work: by rays, or by blocks of streamed "
            "triangles; none runs each process by itself [auto]",
            [&command](const auto& text) {
              command.share = share_from_string(text);
              if (command.share == Share::kGeometry) command.stream = true;
            });
}

void check_streaming(const CLI::App& app, const RenderCommand& command) {
  if (!command.stream && !has_ending(command.scene, ".rsb")) {
    if (app.get_option("--memory")->count() > 0)
      throw CLI::ValidationError("--memory",
                                 "it is only for streamed frames: give --stream or a .rsb file");
    return;
  }
  for (const char* option : {"--clip", "--sequence"}) {
    const CLI::Option* given = app.get_option_no_throw(option);
    if (has_ending(command.scene, ".rsb") && given != nullptr && given->count() > 0)
      throw CLI::ValidationError(option, "in .rsb files only the camera moves");
  }
  if (command.share == Share::kRays)
    throw CLI::ValidationError("--share", "streaming is shared by geometry, not by rays");
  if (app.get_option("--primary")->count() > 0 && command.options.primary == Primary::kRaster)
    throw CLI::ValidationError("--primary", "streaming supports only --primary trace");
  if (command.options.method != Method::kDual)
    throw CLI::ValidationError("--method", "streaming supports only --method dual");
}

}  // namespace raysheaf::app
