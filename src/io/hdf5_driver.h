// The way HDF5 reaches the disk: through an open file descriptor, remembering what it did and the first
// failure.
#pragma once

#include <hdf5.h>

#include "core/changes.h"

namespace cairn::h5 {

/// What happened on the disk.
struct DiskLog {
  int error = 0;  ///< the first error number of the operating system; 0: none
  Changes changes;
};

/// Tells HDF5 to use descriptor `fd` (which stays the caller's) whatever the file's name. `log` must outlive
/// the HDF5 file. With `cut_off` a file that ends too early reads as if zeros followed.
///
/// A failed write is reported to HDF5 as done, and later ones are dropped: HDF5 1.10 cannot close a file that
/// it cannot flush; it leaks its caches and complains on the terminal at exit. Whoever writes must look at
/// `log.error` after closing and throw the file away when it is not 0.
void use_descriptor(hid_t access_list, int fd, DiskLog& log, bool cut_off = false);

}  // namespace cairn::h5
