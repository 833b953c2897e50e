// The way HDF5 reaches the disk: through an open file descriptor, remembering the first failure.
#pragma once

#include <hdf5.h>

namespace cairn::h5 {

/// Tells HDF5 to use descriptor `fd` (which stays the caller's) whatever the file's name. The first error
/// number of the operating system is put into `error`, which must outlive the HDF5 file.
///
/// A failed write is reported to HDF5 as done, and later ones are dropped: HDF5 1.10 cannot close a file that
/// it cannot flush; it leaks its caches and complains on the terminal at exit. Whoever writes must look at
/// `error` after closing and throw the file away when it is not 0.
void use_descriptor(hid_t access_list, int fd, int& error);

}  // namespace cairn::h5
