#include "desk.hpp"

namespace elrom::serve {
namespace {

using repository::Answer;
using repository::Outcome;
using repository::Role;
using repository::Run;
using repository::RunFilter;
using repository::Transaction;

std::string tag_of(const Run& run) { return "\"" + std::to_string(run.revision) + "\""; }

void expect_model(const std::string& name) {
  if (name.empty() || name.size() > 100)
    throw InputError(
        Problem{.what = "no name of a model", .found = "'" + name + "'", .expected = "1 to 100 characters"});
}

std::string model_in(const JsonBody& body) {
  auto model = body.text("model");
  expect_model(model);
  return model;
}

double lease_in(const JsonBody& body) {
  constexpr double longest = 7 * 86400.0;
  const double lease = body.number("lease_s");
  if (lease >= 1 && lease <= longest) return lease;
  throw InputError(
      Problem{.what = "wrong lease_s", .found = body.at("lease_s").dump(), .expected = "1 to 604800 s"});
}

http::Response add_run(Desk& desk, const Ask& ask) {
  const JsonBody body(ask.request.body, {"scenario", "model", "sources"});
  const auto model = model_in(body);
  const auto scenario = body.whole("scenario");
  const auto sources = body.wholes("sources");
  return once(desk, ask, [&](Transaction& transaction) {
    try {
      const auto run = transaction.add_run(scenario, model, sources, ask.caller.name);
      return Answer{.status = 201,
                    .body = document_of(run).dump() + "\n",
                    .tag = tag_of(run),
                    .place = "/runs/" + std::to_string(run.id)};
    } catch (const repository::NotFoundError& error) {
      throw InputError(error.problem());  // it is the request that names what is not there
    }
  });
}

http::Response list_runs(Desk& desk, const Ask& ask) {
  const auto part = part_of(ask);
  RunFilter filter{.model = ask.target.value("model").value_or("")};
  if (const auto scenario = ask.target.value("scenario")) filter.scenario = number_in(*scenario, "scenario");
  if (const auto state = ask.target.value("state"))
    filter.state = repository::run_states.value<UsageError>(*state);
  Json items;
  desk.repository.read([&](Transaction& transaction) {
    items = Json::array();
    for (const auto& run : transaction.runs(filter, part)) items.push_back(document_of(run));
  });
  return json_response(list_document(std::move(items), part));
}

http::Response one_run(Desk& desk, const Ask& ask) {
  Run run;
  desk.repository.read([&](Transaction& transaction) { run = transaction.run(id_of(ask)); });
  return tagged_response(ask, document_of(run), tag_of(run));
}

http::Response claim(Desk& desk, const Ask& ask) {
  const JsonBody body(ask.request.body, {"model", "worker", "lease_s"});
  const auto model = model_in(body);
  const auto worker = body.text("worker");
  const auto lease = lease_in(body);
  return once(desk, ask, [&](Transaction& transaction) {
    const auto run = transaction.claim(model, worker, lease);
    if (!run)
      return Answer{.status = 204, .kept = transaction.changed_runs()};  // masters ask again and again
    auto document = document_of(*run);
    const auto load = transaction.scenario(run->scenario).load;
    document["lease"] = run->lease;
    document["load"] = load < 0 ? Json() : Json(load);
    document["inputs"] = Json::parse(transaction.inputs(run->inputs_digest));
    return Answer{.status = 201, .body = document.dump() + "\n", .place = "/runs/" + std::to_string(run->id)};
  });
}

/// A lease that is renewed twice is renewed: no key is needed.
http::Response renew(Desk& desk, const Ask& ask) {
  const JsonBody body(ask.request.body, {"lease", "lease_s"});
  Run run;
  desk.repository.write([&](Transaction& transaction) {
    run = transaction.renew(id_of(ask), body.text("lease"), lease_in(body));
  });
  return json_response(document_of(run));
}

Outcome outcome_in(const JsonBody& body) {
  Outcome outcome{.state = repository::run_states.value(body.text("state")),
                  .reason = body.text_or("reason", ""),
                  .retry_after_s = body.number_or("retry_after_s", 0)};
  if (outcome.state == repository::RunState::running)
    throw InputError(Problem{
        .what = "wrong state", .found = "running", .expected = "done, failed, quarantined or waiting"});
  if (outcome.state != repository::RunState::done) return outcome;
  outcome.ask = body.texts("ask");
  for (const auto& model : outcome.ask) expect_model(model);
  const auto result = body.object("result", {"version", "verdict", "reason", "document", "fields"});
  outcome.result = {.version = result.text("version"),
                    .verdict = result.text_or("verdict", ""),
                    .reason = result.text_or("reason", ""),
                    .document = result.has("document") ? result.at("document").dump() : "",
                    .fields = result.text_or("fields", "")};
  return outcome;
}

http::Response give_back(Desk& desk, const Ask& ask) {
  const JsonBody body(ask.request.body, {"lease", "state", "reason", "retry_after_s", "result", "ask"});
  const auto outcome = outcome_in(body);
  const auto lease = body.text("lease");
  return once(desk, ask, [&](Transaction& transaction) {
    const auto run = transaction.give_back(id_of(ask), lease, outcome);
    auto document = document_of(run);
    if (run.state == repository::RunState::done) {
      const auto result = transaction.result_of(run.id);
      document["result"] = result.id;
      document["followed_by"] = result.followed_by;
    }
    return Answer{.status = 200, .body = document.dump() + "\n", .tag = tag_of(run)};
  });
}

http::Response result(Desk& desk, const Ask& ask) {
  Json document;
  desk.repository.read(
      [&](Transaction& transaction) { document = document_of(transaction.result(id_of(ask))); });
  return json_response(document);
}

}  // namespace

std::vector<Route> run_routes() {
  return {
      {.method = "GET",
       .path = "/runs",
       .role = Role::reader,
       .summary = "Work of the models, oldest first",
       .answers = {{200, "a part of the list"}, {400, "a query that is none"}},
       .answer = list_runs,
       .query = {{"model", "Of this model"},
                 {"scenario", "Of this scenario"},
                 {"state", "In this state: waiting, running, done, failed, quarantined"},
                 {"after", "The number of the last one that you have"},
                 {"limit", "How many, up to 1000 [default: 100]"}}},
      {.method = "POST",
       .path = "/runs",
       .role = Role::model,
       .summary =
           "Asks for a model's work on a scenario's present inputs; `sources`: results that it builds on",
       .answers = {{201, "it waits"}},
       .answer = add_run,
       .body = BodyKind::json,
       .example = R"({"scenario": 1, "model": "elrom", "sources": []})",
       .wrong = R"({"scenario": 999999, "model": "elrom", "sources": []})",
       .required = {"scenario", "model"},
       .keyed = true},
      {.method = "GET",
       .path = "/runs/{id}",
       .role = Role::reader,
       .summary = "One run",
       .answers = {{200, "it"}},
       .answer = one_run,
       .tagged = true},
      {.method = "POST",
       .path = "/claims",
       .role = Role::model,
       .summary = "Takes the oldest run of a model that waits, or whose master is dead, for so many seconds",
       .answers = {{201, "the run, its inputs and the lease"}, {204, "there is none"}},
       .answer = claim,
       .body = BodyKind::json,
       .example = R"({"model": "elrom", "worker": "machine-1", "lease_s": 60})",
       .wrong = R"({"model": "elrom", "worker": "machine-1", "lease_s": -1})",
       .required = {"model", "worker", "lease_s"},
       .keyed = true},
      {.method = "PUT",
       .path = "/runs/{id}/lease",
       .role = Role::model,
       .summary = "Renews a lease",
       .answers = {{200, "renewed"}, {409, "the run is another's by now"}},
       .answer = renew,
       .body = BodyKind::json,
       .example = R"({"lease": "", "lease_s": 60})",
       .wrong = R"({"lease": "", "lease_s": 0})",
       .required = {"lease", "lease_s"}},
      {.method = "POST",
       .path = "/runs/{id}/outcome",
       .role = Role::model,
       .summary =
           "Gives a run back: done with its result, failed, quarantined, or waiting to be tried again. "
           "`ask`: models that are to work on the same inputs next",
       .answers = {{200, "kept"},
                   {409, "the run is another's by now, or the key was used for another request"}},
       .answer = give_back,
       .body = BodyKind::json,
       .example =
           R"({"lease": "", "state": "done", "reason": "", "retry_after_s": 0, "result": {"version": "1", "verdict": "inside", "reason": "", "document": {}, "fields": ""}, "ask": ["el3d"]})",
       .wrong = R"({"lease": "", "state": "running"})",
       .required = {"lease", "state"},
       .keyed = true},
      {.method = "GET",
       .path = "/results/{id}",
       .role = Role::reader,
       .summary = "What a run came to",
       .answers = {{200, "it"}},
       .answer = result}};
}

}  // namespace elrom::serve
