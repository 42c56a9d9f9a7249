#include "query/posed.h"
#include "simd/query_kernels.h"
#include "voxshell/contacts.h"

namespace voxshell {

bool collides(const Field& field, const PointShell& shell, const Pose& field_from_shell,
              float margin) {
  return with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    return simd::query_kernels<V>(simd::active_isa()).find_any(posed, view_tree(shell), margin);
  });
}

}  // namespace voxshell
