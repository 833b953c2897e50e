#include "shape/mesh_file/file_surface.h"

#include <fmt/format.h>

#include "core/error.h"

namespace cairn {

void CornerCount::settle(FileSurface& surface, const std::string& name) const {
  const auto vertices = static_cast<std::int64_t>(surface.vertices.size());
  std::int64_t base = base_;
  if (base < 0) base = zero_line_ > 0 && greatest_ < vertices ? 0 : 1;
  if (zero_line_ > 0 && base == 1)
    throw InputError("{}:{}: corner 0: expected vertices counted from 1, or all of them from 0", name,
                     zero_line_);
  if (greatest_ >= vertices + base)
    throw InputError("{}:{}: corner {}: expected one of the {} vertices, counted from {}", name,
                     greatest_line_, greatest_, vertices, base);
  if (base == 0)
    surface.notes.emplace_back("facets count their vertices from 0");
  else
    for (std::uint32_t& corner : surface.corners) --corner;
}

}  // namespace cairn
