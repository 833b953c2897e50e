// A wall: a surface that moves as prescribed, or under a load.
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "contact/wall/drive.h"
#include "contact/wall/mesh_surface.h"
#include "contact/wall/motion.h"

namespace cairn {

using WallMesh = std::shared_ptr<const MeshSurface>;
using WallSurface = std::variant<PlaneSurface, SphereSurface, CylinderSurface, WallMesh>;

struct Wall {
  WallSurface surface;  ///< at time 0, but for the oscillation's displacement
  WallMotion motion;
  std::optional<WallDrive> drive = {};

  bool moves() const { return drive || motion.moves(); }
  const MeshSurface* mesh() const {
    const WallMesh* mesh = std::get_if<WallMesh>(&surface);
    return mesh ? mesh->get() : nullptr;
  }
  /// The part of the surface called `feature` as seen from y (wall frame).
  WallTouch extend(std::uint32_t feature, const Vec3& y) const {
    const MeshSurface* m = mesh();
    return m ? m->extend(feature, y) : nearest(y);
  }
  /// A smooth surface as seen from y (wall frame).
  WallTouch nearest(const Vec3& y) const {
    return std::visit(
        [&]<class S>(const S& s) {
          if constexpr (std::is_same_v<S, WallMesh>)
            return WallTouch{};
          else
            return s.nearest(y);
        },
        surface);
  }
  std::size_t features() const { return mesh() ? mesh()->features() : 1; }
};

}  // namespace cairn
