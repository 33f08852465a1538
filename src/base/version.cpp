#include "elrom/base/version.hpp"

namespace elrom {

std::string_view version() { return ELROM_VERSION; }
std::string_view git_hash() { return ELROM_GIT_HASH; }
std::string program_version() {
  return "ELROM " + std::string(version()) + " (" + std::string(git_hash()) + ")";
}

}  // namespace elrom
