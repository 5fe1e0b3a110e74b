#include <fmt/format.h>

#include "apps/support/console.h"
#include "apps/support/table.h"
#include "lab/commands/instances/instances.h"

namespace raysheaf::app {

std::string to_string(InstancesShape shape) {
  return fmt::format("{}x{}", shape.instances, shape.triangles);
}

const char* to_string(InstanceRays kind) {
  return kind == InstanceRays::kCamera ? "camera" : "random";
}

std::string instances_text(const InstancesReport& report) {
  std::string text = fmt::format("compared with {}, {} threads, medians of {} rounds\n",
                                 report.peer, report.threads, report.command.runs);
  Table table({"instances", "triangles", "moved", "kind", "rays", "ours ms", "plan", "levels ms",
               "flat ms", "levels / flat", "peer ms", "ratio", "cpu ratio", "hits", "peer"});
  const auto or_none = [](double value) { return value > 0 ? three_digits(value) : ""; };
  for (const InstancesCase& c : report.cases)
    table.add({std::to_string(c.shape.instances), std::to_string(c.shape.triangles),
               c.moved ? "yes" : "no", to_string(c.kind), std::to_string(c.rays),
               three_digits(c.ours_ms), c.plan, three_digits(c.levels_ms), or_none(c.flat_ms),
               or_none(c.flat_ratio), three_digits(c.peer.ms.total), three_digits(c.peer.ratio),
               three_digits(c.peer.cpu_ratio),
               c.peer.hits.equal() ? "equal" : fmt::format("{} differ", c.peer.hits.mismatches),
               c.peer.version + " " + c.peer.way});
  return text + table.text();
}

std::string instances_csv(const InstancesReport& report) {
  std::string text = fmt::format("# command: {}\n# peer: {}\n# threads: {}\n# runs: {}\n",
                                 printable(report.command.words), report.peer, report.threads,
                                 report.command.runs);
  text +=
      "instances,triangles,moved,kind,rays,update_ms,ours_ms,plan,levels_ms,flat_ms,flat_ratio,"
      "first_ms,peer_version,peer_way,peer_build_ms,peer_trace_ms,peer_ms,ratio,cpu_ratio,hits_"
      "equal,"
      "mismatches,other_triangles,our_mismatches,levels_bytes,flat_bytes,peer_bytes\n";
  for (const InstancesCase& c : report.cases)
    text += fmt::format(
        "{},{},{},{},{},{:.8g},{:.8g},{},{:.8g},{:.8g},{:.8g},{:.8g},{},{},{:.8g},{:.8g},{:.8g},"
        "{:.8g},{:.8g},{},{},{},{},{},{},{}\n",
        c.shape.instances, c.shape.triangles, c.moved ? 1 : 0, to_string(c.kind), c.rays,
        c.update_ms, c.ours_ms, c.plan, c.levels_ms, c.flat_ms, c.flat_ratio, c.first_ms,
        c.peer.version, csv_field(c.peer.way), c.peer.ms.build, c.peer.ms.trace, c.peer.ms.total,
        c.peer.ratio, c.peer.cpu_ratio, c.peer.hits.equal() ? 1 : 0, c.peer.hits.mismatches,
        c.peer.hits.other_triangles, c.peer.hits.sample_mismatches, c.levels_bytes, c.flat_bytes,
        c.peer.bytes);
  return text;
}

}  // namespace raysheaf::app
