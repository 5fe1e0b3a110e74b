// Tests render by every method.
#include "raysheaf/paper.h"

namespace raysheaf::test {
namespace {

[[maybe_unused]] const bool uses_paper = (use_paper_methods(), true);

}  // namespace
}  // namespace raysheaf::test
