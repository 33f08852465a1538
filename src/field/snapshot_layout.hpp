#pragma once
// The parts of a snapshot store that reader and writer share.
// Layout in data/FORMATS.md, kind "elrom-snapshots".

#include <string>
#include <vector>

#include "elrom/field/snapshot_store.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::field::detail {

void write_schema(const io::Hdf5Group& root, const InputSchema& schema);
[[nodiscard]] InputSchema read_schema(const io::Hdf5Group& root);

/// Group /cases, replaced whole: it is small, and a table that is half old cannot then exist.
void write_cases(const io::Hdf5Group& root, const std::vector<CaseRecord>& cases, std::size_t n_inputs,
                 std::size_t n_fields);
[[nodiscard]] std::vector<CaseRecord> read_cases(const io::Hdf5Group& root, std::size_t n_inputs,
                                                 std::size_t n_fields);

/// One empty, growing dataset a field.
void create_fields(const io::Hdf5Group& root, const std::vector<FieldInfo>& fields, const Mesh& mesh);
[[nodiscard]] std::vector<FieldInfo> read_fields(const io::Hdf5Group& root);

}  // namespace elrom::field::detail
