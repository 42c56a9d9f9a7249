#include "query/posed.h"
#include "simd/query_kernels.h"
#include "voxshell/contacts.h"

namespace voxshell {

bool collides(const Field& field, const PointShell& shell, const Pose& field_from_shell,
              float margin) {
  return with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    if (kernels.find_any(posed, view_tree(shell), margin)) return true;
    const EdgeSegments* edges = shell.edges();
    return edges != nullptr && kernels.find_any_edge(posed, edges->view(), margin);
  });
}

}  // namespace voxshell
