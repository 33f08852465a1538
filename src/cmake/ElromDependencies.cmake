# Finds what the components link; used by this build and, installed, by the consumers' find_package(elrom).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(ZLIB REQUIRED)

# Static where the archives are there: a process that lives for twenty milliseconds cannot spend ten on loading libraries.
set(OPENSSL_USE_STATIC_LIBS TRUE)
find_package(OpenSSL QUIET COMPONENTS Crypto)
if(NOT OPENSSL_FOUND)
  set(OPENSSL_USE_STATIC_LIBS FALSE)
  find_package(OpenSSL REQUIRED COMPONENTS Crypto)
endif()

# The serial HDF5, by its own pkg-config file: VTK's packages bring the MPI build, which CMake's module may pick.
find_package(PkgConfig REQUIRED)
pkg_check_modules(HDF5_SERIAL REQUIRED IMPORTED_TARGET GLOBAL hdf5-serial)
# The shared one brings some forty libraries of its network drivers along; the archive's are left out by the linker.
find_library(ELROM_HDF5_ARCHIVE NAMES libhdf5_serial.a HINTS ${HDF5_SERIAL_LIBRARY_DIRS})
find_library(ELROM_SZ_ARCHIVE NAMES libsz.a)
find_library(ELROM_AEC_ARCHIVE NAMES libaec.a)
if(ELROM_HDF5_ARCHIVE AND ELROM_SZ_ARCHIVE AND ELROM_AEC_ARCHIVE)
  # A target rather than a bare path, so that CMake puts what the archive needs behind it on every link line.
  if(NOT TARGET elrom_hdf5_archive)
    add_library(elrom_hdf5_archive STATIC IMPORTED GLOBAL)
  endif()
  set_target_properties(elrom_hdf5_archive PROPERTIES IMPORTED_LOCATION ${ELROM_HDF5_ARCHIVE} INTERFACE_LINK_LIBRARIES
    "${ELROM_SZ_ARCHIVE};${ELROM_AEC_ARCHIVE};ZLIB::ZLIB;OpenSSL::Crypto;${CMAKE_DL_LIBS};m")
  # Archives of some systems need more than this (Debian 13's: curl); those link the shared one.
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_LIBRARIES elrom_hdf5_archive)
  check_cxx_source_compiles("extern \"C\" int H5open(void); int main() { return H5open(); }" ELROM_HDF5_ARCHIVE_LINKS)
  unset(CMAKE_REQUIRED_LIBRARIES)
  if(ELROM_HDF5_ARCHIVE_LINKS)
    # Programs take the archive. Shared libraries (elrom-c, Python's module) cannot: it is not position-independent.
    set(elrom_is_program $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
    set_target_properties(PkgConfig::HDF5_SERIAL PROPERTIES INTERFACE_LINK_LIBRARIES
      "$<${elrom_is_program}:elrom_hdf5_archive>;$<$<NOT:${elrom_is_program}>:${HDF5_SERIAL_LINK_LIBRARIES}>")
  endif()
endif()

if(NOT elrom_FIND_COMPONENTS OR "networks" IN_LIST _elrom_wanted)
  pkg_check_modules(NLOPT REQUIRED IMPORTED_TARGET GLOBAL nlopt)
endif()
if(NOT elrom_FIND_COMPONENTS OR "sql" IN_LIST _elrom_wanted)
  find_package(SQLite3 REQUIRED)
endif()
if(NOT elrom_FIND_COMPONENTS OR "units" IN_LIST _elrom_wanted)
  pkg_check_modules(UDUNITS REQUIRED IMPORTED_TARGET GLOBAL udunits)
endif()
if(ELROM_TORCH)
  find_package(Torch REQUIRED)
endif()
if(ELROM_MPI STREQUAL AUTO)
  find_package(MPI QUIET COMPONENTS C)
elseif(ELROM_MPI)
  find_package(MPI REQUIRED COMPONENTS C)
endif()
# Not by its CMake package: Debian's asks for a program that it does not bring.
if(ELROM_XGBOOST STREQUAL AUTO)
  pkg_check_modules(XGBOOST QUIET IMPORTED_TARGET GLOBAL xgboost)
elseif(ELROM_XGBOOST)
  pkg_check_modules(XGBOOST REQUIRED IMPORTED_TARGET GLOBAL xgboost)
endif()
if(ELROM_TESTS)
  find_package(GTest REQUIRED)
endif()
# What only sources of ours include.
if(NOT elrom_FIND_COMPONENTS)
  find_package(nlohmann_json REQUIRED)
  find_package(CLI11 REQUIRED)
endif()
