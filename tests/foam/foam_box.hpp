#pragma once
// Small polyMeshes and cases for tests.

#include <string>

#include "support/temporary_folder.hpp"

namespace elrom::foam {

/// Two hexahedra on each other: widths in x are 2 at z = 0, 4 at z = 1 and 4 at z = 2; depth 1 in y. Volumes
/// are 3 and 4 m3. @param below for the files' names
inline void write_two_cells(const test::TemporaryFolder& folder, const std::string& below = "") {
  folder.write(below + "points",
               "12((1 0 0)(3 0 0)(3 1 0)(1 1 0)(0 0 1)(4 0 1)(4 1 1)(0 1 1)(0 0 2)(4 0 2)(4 1 2)(0 1 2))");
  folder.write(below + "faces",
               "11(4(4 5 6 7)"  // between the cells
               "4(0 3 2 1)4(0 1 5 4)4(1 2 6 5)4(2 3 7 6)4(3 0 4 7)"
               "4(8 9 10 11)4(4 5 9 8)4(5 6 10 9)4(6 7 11 10)4(7 4 8 11))");
  folder.write(below + "owner", "11(0 0 0 0 0 0 1 1 1 1 1)");
  folder.write(below + "neighbour", "1(1)");
}

}  // namespace elrom::foam
