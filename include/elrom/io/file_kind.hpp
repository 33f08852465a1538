#pragma once
// What our files say of themselves: `kind`, `format` (a version pair) and `program`, in HDF5 attributes,
// texts of tensor files, keys of JSON documents or rows of SQLite's table `about` (data/FORMATS.md). Every
// kind that ELROM writes is in the table below, and every reader asks check_kind: it takes its own major
// version with any minor one, and refuses all else in the same words.
//
// Thread rule: pure functions.

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "elrom/base/version.hpp"

namespace elrom::io {

struct FileKind {
  std::string_view name;
  FormatVersion version;    ///< that this ELROM writes
  std::string_view remedy;  ///< what makes such a file anew, after "use the ELROM that wrote it, or"
};

namespace kinds {
inline constexpr FileKind mesh{"elrom-mesh", {1, 0}, "make it again with elrom-data mesh"};
inline constexpr FileKind snapshots{
    "elrom-snapshots", {1, 1}, "import the cases again with elrom-data import"};
inline constexpr FileKind bundle{"elrom-bundle", {1, 5}, "train again with elrom-train run"};
inline constexpr FileKind prediction{"elrom-prediction", {1, 1}, "predict again with elrom-predict"};
inline constexpr FileKind manifest{"elrom-manifest", {1, 0}, "fetch the shipped cases again"};
inline constexpr FileKind check{"elrom-check", {1, 1}, "check again with elrom-data check"};
inline constexpr FileKind split{"elrom-split", {1, 1}, "train again with elrom-train run"};
inline constexpr FileKind timing{"elrom-timing", {1, 1}, "remove it"};
inline constexpr FileKind trials{"elrom-trials", {1, 0}, "remove it to search anew"};
inline constexpr FileKind stage{"elrom-stage", {1, 0}, "remove it"};
inline constexpr FileKind checkpoint{"elrom-checkpoint", {1, 0}, "remove it"};
inline constexpr FileKind versions{"elrom-versions", {1, 0}, "use a copy of it"};
inline constexpr FileKind retrain{"elrom-retrain", {1, 1}, "retrain again with elrom-train retrain"};
inline constexpr FileKind accuracy{"elrom-accuracy", {1, 4}, "report again with elrom-report accuracy"};
inline constexpr FileKind comparison{"elrom-comparison", {1, 0}, "compare again with elrom-report compare"};
inline constexpr FileKind learning_curve{
    "elrom-learning-curve", {1, 2}, "draw it again with elrom-report learning-curve"};
inline constexpr FileKind cost{"elrom-cost", {1, 1}, "report again with elrom-report cost"};
inline constexpr FileKind collisions{
    "elrom-collisions", {1, 0}, "make them again with elrom-data collisions"};
inline constexpr FileKind collision_summary{
    "elrom-collision-summary", {1, 0}, "make it again with elrom-data collisions"};
inline constexpr FileKind collision{"elrom-collision", {1, 0}, "train again with elrom-train collisions"};
inline constexpr FileKind collision_training{
    "elrom-collision-training", {1, 0}, "train again with elrom-train collisions"};
inline constexpr FileKind collision_report{
    "elrom-collision-report", {1, 0}, "report again with elrom-report collisions"};
inline constexpr FileKind scene_checkpoint{
    "elrom-scene-checkpoint", {2, 0}, "remove it and simulate again with elrom-simulate"};
inline constexpr FileKind scene_summary{"elrom-scene", {1, 1}, "simulate again with elrom-simulate"};
inline constexpr FileKind scene_report{"elrom-scene-report", {1, 0}, "report again with elrom-report scenes"};
inline constexpr FileKind repository{"elrom-repository", {1, 1}, "restore it from a backup"};

inline constexpr std::array all{mesh,
                                snapshots,
                                bundle,
                                prediction,
                                manifest,
                                check,
                                split,
                                timing,
                                trials,
                                stage,
                                checkpoint,
                                versions,
                                retrain,
                                accuracy,
                                comparison,
                                learning_curve,
                                cost,
                                collisions,
                                collision_summary,
                                collision,
                                collision_training,
                                collision_report,
                                scene_checkpoint,
                                scene_summary,
                                scene_report,
                                repository};
}  // namespace kinds

/// What a file says of itself; nothing where it says nothing.
struct FoundKind {
  std::optional<std::string> kind, format, program;  ///< format: "1.0"
};

/// @return the file's version
/// @throws InputError naming the file, what was found and what was expected: for another kind or none, for a
/// version that is no pair of whole numbers, for a major version other than ours
FormatVersion check_kind(const FoundKind& found, const FileKind& expected, const std::string& where);

/// The same for a JSON document (nlohmann::json or its ordered form, which the caller includes).
template <class Json>
FormatVersion check_json_kind(const Json& root, const FileKind& expected, const std::string& where) {
  const auto text = [&](const char* key) -> std::optional<std::string> {
    if (!root.is_object() || !root.contains(key)) return std::nullopt;
    const auto& value = root.at(key);
    if (value.is_string()) return value.template get<std::string>();
    const bool is_pair = value.is_array() && value.size() == 2;
    return is_pair ? value[0].dump() + "." + value[1].dump() : value.dump();
  };
  return check_kind({text("kind"), text("format"), text("program")}, expected, where);
}

/// The keys that every JSON document of ours begins with.
template <class Json>
[[nodiscard]] Json json_head(const FileKind& kind) {
  return {{"kind", kind.name},
          {"format", {kind.version.major, kind.version.minor}},
          {"program", program_version()}};
}

}  // namespace elrom::io
