#pragma once
// What an answer is made of.

#include <memory>
#include <mutex>

#include "cuts.hpp"
#include "elrom/repository/rules.hpp"
#include "elrom/serve/service.hpp"
#include "json_body.hpp"
#include "metrics.hpp"
#include "reports.hpp"
#include "route.hpp"

namespace elrom::serve {

struct Desk {
  ServiceOptions options;
  repository::Repository repository;
  ResidentModel model;
  Metrics metrics;
  Reports reports;
  std::mutex hdf5;  ///< the library is not thread-safe

  explicit Desk(ServiceOptions wanted)
      : options(std::move(wanted)),
        repository(options.repository),
        model(options.model),
        reports(options.repository.folder / "reports", options.report_program) {}
};

/// A JSON document as an answer.
[[nodiscard]] http::Response json_response(const Json& document, int status = 200);
/// The same with an ETag; 304 where the caller has it already.
[[nodiscard]] http::Response tagged_response(const Ask& ask, const Json& document, const std::string& tag);
/// 304 where the caller has it already; nothing: it is to be sent, with the tag.
[[nodiscard]] std::optional<http::Response> known_already(const http::Request& request,
                                                          const std::string& tag);

/// A write by its Idempotency-Key: done once, answered again. Kept answers are JSON.
[[nodiscard]] http::Response once(Desk& desk, const Ask& ask,
                                  const std::function<repository::Answer(repository::Transaction&)>& work);

/// Of a path's {id}. @throws NotFoundError for what is no number
[[nodiscard]] repository::Id id_of(const Ask& ask, std::size_t i = 0);
/// Of a query. @throws UsageError for what is no number from 0 to `most`
[[nodiscard]] std::int64_t number_in(const std::string& text, const std::string& name,
                                     std::int64_t most = std::numeric_limits<std::int64_t>::max());
/// ?after=&limit=. @throws UsageError
[[nodiscard]] repository::ListPart part_of(const Ask& ask);
/// {"items": [...], "next": ...}: `next` is what to give as `after`, null at the end.
[[nodiscard]] Json list_document(Json items, const repository::ListPart& part);

/// The model that answers now. @throws NotFoundError
[[nodiscard]] std::shared_ptr<const OpenModel> open_model(Desk& desk);
/// ?axis=&at=. @throws UsageError
[[nodiscard]] Cut cut_in_query(const Ask& ask, const Cuts& cuts);
/// A body's "case", "load" and "inputs". @throws InputError
[[nodiscard]] repository::JudgedInputs judge_case(const JsonBody& body, const OpenModel& model);
/// What elrom-predict can write here: "hdf", "csv" ...; openfoam only onto a case.
[[nodiscard]] std::vector<std::string> file_formats(const Desk& desk);

// Records as documents.
[[nodiscard]] Json document_of(const repository::Scenario& scenario);
[[nodiscard]] Json document_of(const repository::Run& run);  ///< without its lease, which is a secret
[[nodiscard]] Json document_of(const repository::ModelResult& result);
[[nodiscard]] Json document_of(const repository::Quarantined& quarantined);
[[nodiscard]] Json document_of(const repository::Token& token);

// Answers, by what they are about.
[[nodiscard]] std::vector<Route> server_routes();    // answers_server.cpp: health, metrics, tokens
[[nodiscard]] std::vector<Route> scenario_routes();  // answers_scenarios.cpp
[[nodiscard]] std::vector<Route> run_routes();       // answers_runs.cpp
[[nodiscard]] std::vector<Route> field_routes();     // answers_fields.cpp
[[nodiscard]] std::vector<Route> model_routes();     // answers_model.cpp
[[nodiscard]] std::vector<Route> version_routes();   // answers_versions.cpp
[[nodiscard]] std::vector<Route> file_routes();      // answers_files.cpp: what elrom-predict writes

}  // namespace elrom::serve
