// What a run starts from: bodies, and what their numbers refer to.
#pragma once

#include <string>
#include <vector>

#include "body/bodies.h"
#include "contact/walls.h"

namespace cairn {

struct Setup {
  Bodies bodies;
  std::vector<std::string> shapes;  ///< name of each shape number
  std::vector<Plane> planes;
};

}  // namespace cairn
