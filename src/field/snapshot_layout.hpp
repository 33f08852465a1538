#pragma once
// The parts of a snapshot store that reader and writer share.
// Layout in data/FORMATS.md, kind "elrom-snapshots".

#include <optional>
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

/// Its text, in place of an earlier one.
void write_furnace(const io::Hdf5Group& root, const Furnace& furnace);
/// Nothing in stores before 1.1, or of cases whose furnace nobody described.
[[nodiscard]] std::optional<Furnace> read_furnace(const io::Hdf5Group& root);

/// One empty, growing dataset a field.
void create_fields(const io::Hdf5Group& root, const std::vector<FieldInfo>& fields, const Mesh& mesh);
[[nodiscard]] std::vector<FieldInfo> read_fields(const io::Hdf5Group& root);

}  // namespace elrom::field::detail
