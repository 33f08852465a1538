#pragma once
// A folder as one file: POSIX tar (ustar), which every system unpacks.
//
// Thread rule: pure function.

#include <filesystem>
#include <string>

namespace elrom::serve {

/// Regular files below `folder`, named from it on ("0/U" of ".../0"), in the order of their names.
/// @throws InputError for one that cannot be read, or whose name is longer than 99 characters
[[nodiscard]] std::string tar_of(const std::filesystem::path& folder);

}  // namespace elrom::serve
