// What a run starts from: bodies, and what their numbers refer to.
#pragma once

#include <string>
#include <vector>

#include "body/cells.h"
#include "contact/box.h"
#include "contact/history.h"

namespace cairn {

struct Setup {
  Bodies bodies;
  Frame frame;  ///< of the bodies at the start
  Frame shift;  ///< the same from the zero of the scene
  Box box;
  std::vector<std::string> shapes;      ///< name of each shape number
  std::vector<ContactRecord> contacts;  ///< of a pile read from a file
  double region_volume = 0.0;           ///< m^3, see State
  double k_n = 0.0;                     ///< N/m, stiffness those contacts had; 0: none
};

}  // namespace cairn
