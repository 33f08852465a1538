#pragma once
// Backup and restore. A backup is a repository of its own: a folder with an SQLite database and the files of
// fields that it names, whatever database it was made from; elrom-serve may open it as it is. So both ways
// are the same copy, and a repository moves from SQLite to PostgreSQL by them.
//
// Thread rule: any thread, beside servers that write.

#include <cstdint>
#include <filesystem>

#include "elrom/repository/repository.hpp"

namespace elrom::repository {

struct Copied {
  std::int64_t rows = 0, files = 0, bytes = 0;  ///< bytes: of the files
};

/// What is there at one moment, though others write meanwhile: the rows of one snapshot, and files, which
/// never change and are in place before a row names them.
/// @param backup folder; it appears whole or not at all. @throws UsageError when something is there already;
///        InputError for a damaged file of fields; SystemError
Copied back_up(const RepositoryOptions& from, const std::filesystem::path& backup);

/// @param to a repository without anything in it; made when missing. @throws UsageError when it holds
///        something; InputError for a folder that is no backup, or a damaged one. The rows are then not there
Copied restore(const std::filesystem::path& backup, const RepositoryOptions& to);

}  // namespace elrom::repository
