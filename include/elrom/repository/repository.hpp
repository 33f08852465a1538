#pragma once
// The repository: what the models of a boiler exchange. A folder with a database (SQLite there, or a
// PostgreSQL elsewhere; data/FORMATS.md, kind "elrom-repository") and the files of fields beside it.
//
// A write that a caller names by a key is done once, however often it comes: key, digest of what was asked
// and the answer are kept in the transaction of the write itself.
//
// Thread rule: any thread.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "elrom/repository/field_files.hpp"
#include "elrom/repository/transaction.hpp"

namespace elrom::repository {

/// A write as its caller names it.
struct Call {
  std::string key;     ///< the caller's own, new for each write
  std::string digest;  ///< of all that is asked
};

/// What a caller is told, and told again when he repeats himself.
struct Answer {
  int status = 200;
  std::string body = {};
  std::string tag = {};    ///< revision of what it is about, for optimistic locking
  std::string place = {};  ///< of what was made
  bool repeated = false;
  bool kept = true;  ///< false: nothing was done, and nothing is to be remembered of it
};

struct RepositoryOptions {
  std::filesystem::path folder;        ///< made when missing
  std::string database = "sqlite";     ///< or "postgresql://user@host/name"
  std::function<double()> clock = {};  ///< seconds since 1970; empty: the system's
};

class Repository {
 public:
  /// Opens, makes, or brings to the present schema. @throws InputError for a database of another kind or a
  /// newer major version, UsageError for an unknown kind of database, NotBuiltError, SystemError
  explicit Repository(RepositoryOptions options);
  ~Repository();

  using Work = std::function<void(Transaction&)>;
  /// In a transaction of its own, which is begun again when another was first: `work` may run several times.
  void read(const Work& work) const;
  void write(const Work& work);
  /// @throws ConflictError when the key came before with another digest; what `work` throws keeps nothing
  Answer once(const Call& call, const std::function<Answer(Transaction&)>& work);
  /// Forgets the answers to calls that are older; their keys are free again.
  void forget_calls(double before);

  [[nodiscard]] const FieldFiles& fields() const { return fields_; }
  [[nodiscard]] double now() const;

 private:
  struct Impl;
  FieldFiles fields_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::repository
