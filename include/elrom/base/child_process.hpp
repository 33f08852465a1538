#pragma once
// Work that may crash, hang or eat memory, tried in a child process first: what kills the child becomes an
// error here.
//
// Thread rule: call it while no other thread is inside the library that `work` uses (a lock held at the
// moment of the fork stays held in the child).

#include <cstddef>
#include <functional>
#include <string>

namespace elrom::base {

struct ChildLimits {
  double seconds = 60;
  std::size_t memory_bytes = std::size_t{4} << 30;  ///< beyond what this process has mapped already
};

/// Runs `work` in a fork of this process and waits for it.
/// @param culprit for messages: "the HDF5 library"; @param where the file it reads
/// @throws InputError when the child crashed, took too long or too much memory; or with the message of the
///         error that `work` threw there. Nothing that `work` did remains.
void try_in_child(const std::string& culprit, const std::string& where, const std::function<void()>& work,
                  const ChildLimits& limits = {});

}  // namespace elrom::base
