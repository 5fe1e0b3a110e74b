// `raysheaf completion` and `raysheaf manual`.
#include <algorithm>
#include <filesystem>

#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "options.h"
#include "raysheaf/io.h"
#include "raysheaf/version.h"

namespace raysheaf::app {

int run(const CompletionCommand& command) {
  print(completion_script(command.raysheaf, command.shell));
  return kSuccess;
}

int run(const ManualCommand& command) {
  for_each_command(command.raysheaf, [&](const CommandText& below) {
    std::string name = below.name + ".1";
    std::replace(name.begin(), name.end(), ' ', '-');
    write_text(manual_page(below, RAYSHEAF_VERSION),
               (std::filesystem::path(command.folder) / name).string());
  });
  return kSuccess;
}

}  // namespace raysheaf::app
