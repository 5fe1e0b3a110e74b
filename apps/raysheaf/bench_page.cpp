#include "bench_page.h"

namespace raysheaf::app {
std::string paper_page(const PaperReport& report, bool times) {
  (void)report;
  (void)times;
  return "";
}
}  // namespace raysheaf::app
