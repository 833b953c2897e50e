// Memory that is not needed any more.
#pragma once

#include <vector>

namespace cairn {

/// Empties a vector and frees what it holds; `= {}` would keep it.
template <class T>
void give_back(std::vector<T>& vector) {
  std::vector<T>().swap(vector);
}

}  // namespace cairn
