# One function makes a component's library: strict warnings, C++20, and the shared compile options.
find_program(ELROM_CCACHE ccache)
if(ELROM_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache accepts precompiled headers only when told that their time stamps do not matter.
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${ELROM_CCACHE})
endif()

function(elrom_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wno-missing-field-initializers)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${target} PRIVATE
                           # GCC 12 false alarms: in std::string (its bug 105329) ...
                           -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds
                           # ... and in its AVX-512 intrinsics, through Eigen (its bug 105593)
                           -Wno-maybe-uninitialized -Wno-uninitialized
                           # A tenth of the time of a compilation is collecting garbage that there is memory enough to keep.
                           --param=ggc-min-expand=400 --param=ggc-min-heapsize=400000)
  endif()
  if(ELROM_NATIVE)
    # Public: Eigen's alignment follows the instruction set, and must be the same in every object of a program.
    target_compile_options(${target} PUBLIC $<BUILD_INTERFACE:-march=native>)
  endif()
  if(ELROM_SANITIZE)
    # What a sanitizer finds ends the program: a message nobody reads is no finding.
    target_compile_options(${target} PUBLIC $<BUILD_INTERFACE:-fsanitize=${ELROM_SANITIZE}> $<BUILD_INTERFACE:-fno-omit-frame-pointer>
                           $<BUILD_INTERFACE:-fno-sanitize-recover=all>)
    target_link_options(${target} PUBLIC $<BUILD_INTERFACE:-fsanitize=${ELROM_SANITIZE}>)
  endif()
endfunction()

# The standard and third-party headers that nearly every source reads, parsed once a target. Sources still include what they
# use: the debug preset builds without.
set(ELROM_COMMON_HEADERS <algorithm> <filesystem> <functional> <map> <memory> <span> <string> <vector>
                         <Eigen/Core> ${PROJECT_SOURCE_DIR}/src/io/json_instances.hpp)
# Only sources see it, so that who uses an installed ELROM needs no JSON library.
set(ELROM_JSON $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
function(elrom_precompile target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  target_compile_options(${target} PRIVATE -fpch-preprocess)  # lets ccache see through the precompiled header
endfunction()

# elrom_unity(target): with ELROM_UNITY a few sources are compiled at once. What they instantiate (Eigen, JSON, fmt, matchers,
# CLI11) is much the same: half the time from nothing, but more of it after one edit.
function(elrom_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${ELROM_UNITY} UNITY_BUILD_BATCH_SIZE 14)
  if(ELROM_UNITY)
    # To the compiler all but one of them are headers, which should not use unnamed namespaces; they see each other's names.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage -Wno-shadow)
  endif()
endfunction()

# The header of the libraries is of a target that links nothing: what one of them defines beside (fmt's FMT_HEADER_ONLY) must
# not be in it, or GCC takes it for none of the others.
function(elrom_library_headers)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/library_headers.cpp CONTENT "")
  add_library(elrom-library-headers OBJECT ${PROJECT_BINARY_DIR}/library_headers.cpp)
  set_target_properties(elrom-library-headers PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(elrom-library-headers PRIVATE Eigen3::Eigen Threads::Threads ${ELROM_JSON})
  target_compile_definitions(elrom-library-headers PRIVATE ${ELROM_DEFINITIONS})
  elrom_compile_options(elrom-library-headers)
  elrom_precompile(elrom-library-headers ${ELROM_COMMON_HEADERS})
endfunction()

# elrom_install(name) -> target elrom-<name> as component <name> of find_package(elrom)
function(elrom_install name)
  install(TARGETS elrom-${name} EXPORT elrom-${name}-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT elrom-${name}-targets NAMESPACE elrom:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/elrom)
endfunction()

# elrom_library(name [SOURCES ...] [HEADERS folders ...] LINKS ... PRIVATE_LINKS ...) -> target elrom-<name>, alias elrom::<name>,
# installed with component <name>. Its sources: those of the folder <name>, where none are given; its public headers: those of
# include/elrom/<name>, where no folders are.
function(elrom_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;LINKS;PRIVATE_LINKS" ${ARGN})
  if(NOT ARG_SOURCES)
    file(GLOB ARG_SOURCES CONFIGURE_DEPENDS ${name}/*.cpp)
  endif()
  add_library(elrom-${name} STATIC ${ARG_SOURCES})
  add_library(elrom::${name} ALIAS elrom-${name})
  set_target_properties(elrom-${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(elrom-${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(elrom-${name} PUBLIC ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS} ${ELROM_JSON})
  elrom_compile_options(elrom-${name})
  elrom_unity(elrom-${name})
  # One header parsed for all; LibTorch's has its own.
  if(name STREQUAL torch)
    elrom_precompile(elrom-torch <torch/types.h> ${ELROM_COMMON_HEADERS})
  else()
    target_precompile_headers(elrom-${name} REUSE_FROM elrom-library-headers)
    target_compile_options(elrom-${name} PRIVATE -fpch-preprocess)
  endif()
  elrom_install(${name})
  if(NOT ARG_HEADERS)
    set(ARG_HEADERS ${name})
  endif()
  foreach(folder IN LISTS ARG_HEADERS)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/elrom/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/elrom)
  endforeach()
endfunction()

# The optimiser is the larger half of the compile time of tests and of what reads command lines, and none of them computes.
# A precompiled header brings the level it was made with along, so each level has its own.
set(ELROM_DRIVER_OPTIMISATION $<$<CONFIG:Release>:-O1>)

# elrom_driver(target [LIBTORCH]) -> compiled like all programs: little optimised, with the header they share, which knows fmt.
# LIBTORCH: the sources include it; they are compiled as elrom::torch is, whose header they take.
function(elrom_driver target)
  cmake_parse_arguments(ARG "LIBTORCH" "" "" ${ARGN})
  elrom_compile_options(${target})
  target_link_libraries(${target} PRIVATE fmt::fmt ${ELROM_JSON})  # what the header was compiled with
  if(ARG_LIBTORCH)
    target_precompile_headers(${target} REUSE_FROM elrom-torch)
    target_compile_options(${target} PRIVATE -fPIC -fpch-preprocess)
    return()
  endif()
  if(NOT TARGET elrom-driver-headers)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/driver_headers.cpp CONTENT "")
    add_library(elrom-driver-headers OBJECT ${PROJECT_BINARY_DIR}/driver_headers.cpp)
    target_link_libraries(elrom-driver-headers PRIVATE elrom::core fmt::fmt ${ELROM_JSON})
    elrom_compile_options(elrom-driver-headers)
    target_compile_options(elrom-driver-headers PRIVATE ${ELROM_DRIVER_OPTIMISATION})
    elrom_precompile(elrom-driver-headers ${ELROM_COMMON_HEADERS} <fmt/format.h>)
  endif()
  target_precompile_headers(${target} REUSE_FROM elrom-driver-headers)
  target_compile_options(${target} PRIVATE ${ELROM_DRIVER_OPTIMISATION} -fpch-preprocess)
endfunction()

# elrom_program(elrom-xyz SOURCES ... LINKS ...) -> <build>/bin/elrom-xyz, installed to bin.
# The target is elrom-xyz, or elrom-xyz-program where a library's target has that name.
function(elrom_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  set(target ${name})
  if(TARGET ${name})
    set(target ${name}-program)
  endif()
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LINKS})
  elrom_driver(${target})
  elrom_unity(${target})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name} RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

function(elrom_test_options target)
  elrom_compile_options(${target})
  target_link_libraries(${target} PRIVATE ${ELROM_JSON})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${target} PRIVATE ELROM_SOURCE_DIR="${PROJECT_SOURCE_DIR}" ELROM_BIN_DIR="${PROJECT_BINARY_DIR}/bin")
endfunction()

# elrom_tests(component [LIBTORCH] [TIMEOUT s] LINKS ...) -> one program of all *_test.cpp of this folder, and one CTest entry
# a test case, <component>/<Suite>.<Case>. The component's internal headers can be included.
# Slow or statistical work belongs into tests/benchmark, which CTest does not run.
function(elrom_tests component)
  cmake_parse_arguments(ARG "LIBTORCH" "TIMEOUT;INTERNAL" "SOURCES;LINKS" ${ARGN})
  set(name test-${component})
  if(NOT ARG_SOURCES)
    file(GLOB ARG_SOURCES CONFIGURE_DEPENDS *_test.cpp)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gmock GTest::gtest_main)
  elrom_test_options(${name})
  if(ARG_INTERNAL)
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/${ARG_INTERNAL})
  endif()
  # Nearly all tests share one precompiled header, and so one set of compile options. LIBTORCH: the tests include it, and are
  # compiled as elrom::torch is, whose header they take.
  if(ARG_LIBTORCH)
    target_precompile_headers(${name} REUSE_FROM elrom-torch)
    target_compile_options(${name} PRIVATE -fPIC -fpch-preprocess)
  else()
    target_precompile_headers(${name} REUSE_FROM test-headers)
    target_compile_options(${name} PRIVATE ${ELROM_DRIVER_OPTIMISATION} -fpch-preprocess)
  endif()
  elrom_unity(${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  gtest_discover_tests(${name} TEST_PREFIX ${component}/ DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT})
endfunction()
