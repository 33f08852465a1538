# Finds what the components link; used by this build and, installed, by the consumers' find_package(elrom).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)

# The serial HDF5, by its own pkg-config file: VTK's packages bring the MPI build, which CMake's module may pick.
find_package(PkgConfig REQUIRED)
pkg_check_modules(HDF5_SERIAL REQUIRED IMPORTED_TARGET GLOBAL hdf5-serial)

if(NOT elrom_FIND_COMPONENTS OR "study" IN_LIST _elrom_wanted)
  pkg_check_modules(NLOPT REQUIRED IMPORTED_TARGET GLOBAL nlopt)
  find_package(SQLite3 REQUIRED)
endif()
if(ELROM_TORCH)
  find_package(Torch REQUIRED)
endif()
if(ELROM_TESTS)
  find_package(GTest REQUIRED)
endif()
find_package(CLI11 REQUIRED)
