#pragma once
// Everything that elrom-serve answers: the repository and the resident predictor by REST, a page's files,
// metrics. data/serve/routes.cpp is the table of it; GET /openapi.json is the same for callers.
//
// Thread rule: any thread, as http::Handler.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "elrom/http/server.hpp"
#include "elrom/repository/repository.hpp"
#include "elrom/serve/resident_model.hpp"

namespace elrom::serve {

struct ServiceOptions {
  repository::RepositoryOptions repository;
  std::filesystem::path model;            ///< a bundle's file or a study's folder; may come to be later
  std::filesystem::path page;             ///< folder of a page's files; empty: none
  std::filesystem::path predict_program;  ///< elrom-predict, which writes files; empty: none are offered
  std::filesystem::path report_program;   ///< elrom-report, which makes reports; empty: none are made
  std::filesystem::path openfoam_case;    ///< that starts are made for; empty: none
  /// Looks at an uploaded file of fields, as repository::judge_fields() does, where its crash is no harm.
  /// @param bundle whose mesh and furnace it must be of; empty: there is no model yet
  std::function<void(const std::filesystem::path& file, const std::filesystem::path& bundle)> judge_upload =
      {};
  std::optional<repository::Role> anonymous = {};  ///< of who brings no token; nothing: he may do nothing
  std::function<void(const std::string& line)> log = {};  ///< told of every request, a JSON object in a line
  std::size_t most_json_bytes = std::size_t{1} << 20;
  std::size_t most_fields_bytes = std::size_t{64} << 20;
};

class Service final : public http::Handler {
 public:
  /// @throws as Repository
  explicit Service(ServiceOptions options);
  ~Service() override;

  [[nodiscard]] repository::Repository& repository();
  [[nodiscard]] ResidentModel& model();

  [[nodiscard]] std::size_t body_limit(const http::Request& head) const override;
  [[nodiscard]] http::Response handle(const http::Request& request) override;
  [[nodiscard]] http::Response refuse(int status, const Problem& problem) override;
  void done(const http::Exchange& exchange) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For ServiceOptions::judge_upload: `program --judge-fields FILE --model BUNDLE`, a process of its own,
/// which ends with 0, or with another status and the reason in its last line. It has a minute.
/// @throws InputError with that reason, or for a process that crashed
void judge_in_process(const std::filesystem::path& program, const std::filesystem::path& file,
                      const std::filesystem::path& bundle);

}  // namespace elrom::serve
