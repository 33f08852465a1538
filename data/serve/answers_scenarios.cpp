#include "desk.hpp"
#include "elrom/repository/rules.hpp"
#include "problem.hpp"

namespace elrom::serve {
namespace {

using repository::Answer;
using repository::Role;
using repository::Scenario;
using repository::Transaction;

const std::vector<std::string> scenario_keys{"name", "boiler", "note", "load", "inputs"};

std::string tag_of(const Scenario& scenario) { return "\"" + std::to_string(scenario.revision) + "\""; }

/// @throws InputError for boundary conditions that are wrong
Scenario judged(Desk& desk, const Ask& ask, const JsonBody& body) {
  Scenario scenario{.name = body.text("name"),
                    .boiler = body.text_or("boiler", ""),
                    .note = body.text_or("note", ""),
                    .load = body.number_or("load", -1),
                    .by = ask.caller.name};
  Json one{{"case", scenario.name}, {"inputs", body.at("inputs")}};
  if (body.has("load")) one["load"] = scenario.load;
  const auto model = desk.model.now();
  const auto found = repository::judge_inputs(one.dump(), "scenario", model ? &model->schema() : nullptr,
                                              model ? &model->guard() : nullptr);
  scenario.inputs = found.document;
  if (found.assessment) {
    scenario.verdict = model::name_of(found.assessment->verdict);
    scenario.reason = found.assessment->reason;
  }
  return scenario;
}

/// What is wrong is kept with the reason, and no model will see it.
Answer put_aside(const Ask& ask, const InputError& fault, Transaction& transaction) {
  const auto kept = transaction.quarantine(
      {.kind = "scenario", .document = ask.request.body, .reason = fault.what(), .by = ask.caller.name});
  const auto place = "/quarantine/" + std::to_string(kept.id);
  auto problem = Json::parse(problem_response(fault).body);
  problem["quarantine"] = place;
  return {.status = 422, .body = problem.dump() + "\n", .place = place};
}

/// What `work` does with a scenario that is sound.
http::Response write_scenario(Desk& desk, const Ask& ask,
                              const std::function<Answer(Transaction&, Scenario)>& work) {
  const JsonBody body(ask.request.body, scenario_keys);
  std::optional<Scenario> scenario;
  std::optional<InputError> fault;
  try {
    scenario = judged(desk, ask, body);
  } catch (const InputError& error) {
    fault = error;
  }
  return once(desk, ask, [&](Transaction& transaction) {
    return fault ? put_aside(ask, *fault, transaction) : work(transaction, *scenario);
  });
}

Answer answer_with(const Scenario& scenario, int status) {
  return {.status = status,
          .body = document_of(scenario).dump() + "\n",
          .tag = tag_of(scenario),
          .place = "/scenarios/" + std::to_string(scenario.id)};
}

http::Response add_scenario(Desk& desk, const Ask& ask) {
  return write_scenario(desk, ask, [](Transaction& transaction, Scenario scenario) {
    return answer_with(transaction.add(std::move(scenario)), 201);
  });
}

/// The number in an ETag of ours; -1: none.
std::int64_t revision_in(const std::string& tag) {
  try {
    return tag.size() > 2 && tag.front() == '"' && tag.back() == '"'
               ? std::stoll(tag.substr(1, tag.size() - 2))
               : -1;
  } catch (const std::exception&) {
    return -1;
  }
}

http::Response change(Desk& desk, const Ask& ask) {
  const auto id = id_of(ask);
  const auto revision = revision_in(*ask.request.header("If-Match"));
  return write_scenario(desk, ask, [&](Transaction& transaction, Scenario scenario) {
    scenario.id = id;
    return answer_with(transaction.change(std::move(scenario), revision), 200);
  });
}

http::Response list_scenarios(Desk& desk, const Ask& ask) {
  const auto part = part_of(ask);
  Json items;
  desk.repository.read([&](Transaction& transaction) {
    items = Json::array();
    for (const auto& one : transaction.scenarios(part)) items.push_back(document_of(one));
  });
  return json_response(list_document(std::move(items), part));
}

http::Response one_scenario(Desk& desk, const Ask& ask) {
  Scenario scenario;
  desk.repository.read([&](Transaction& transaction) { scenario = transaction.scenario(id_of(ask)); });
  return tagged_response(ask, document_of(scenario), tag_of(scenario));
}

http::Response results(Desk& desk, const Ask& ask) {
  const auto part = part_of(ask);
  Json items;
  desk.repository.read([&](Transaction& transaction) {
    items = Json::array();
    (void)transaction.scenario(id_of(ask));
    for (const auto& result : transaction.results(id_of(ask), part)) items.push_back(document_of(result));
  });
  return json_response(list_document(std::move(items), part));
}

http::Response quarantine(Desk& desk, const Ask& ask) {
  const auto part = part_of(ask);
  Json items;
  desk.repository.read([&](Transaction& transaction) {
    items = Json::array();
    for (const auto& kept : transaction.quarantine_list(part)) items.push_back(document_of(kept));
  });
  return json_response(list_document(std::move(items), part));
}

http::Response quarantined(Desk& desk, const Ask& ask) {
  Json document;
  desk.repository.read(
      [&](Transaction& transaction) { document = document_of(transaction.quarantined(id_of(ask))); });
  return json_response(document);
}

const std::vector<Parameter> list_query{{"after", "The number of the last one that you have"},
                                        {"limit", "How many, up to 1000 [default: 100]"}};
constexpr const char* example =
    R"({"name": "full load", "boiler": "furnace", "note": "", "load": 1.0, "inputs": {"steam [t/h]": 1296}})";
constexpr const char* wrong =
    R"({"name": "full load", "boiler": "furnace", "note": "", "load": 1.0, "inputs": {"steam [t/h]": -1296}})";

}  // namespace

std::vector<Route> scenario_routes() {
  return {
      {.method = "GET",
       .path = "/scenarios",
       .role = Role::reader,
       .summary = "Operating points, oldest first",
       .answers = {{200, "a part of the list; `next` goes on"}, {400, "a query that is none"}},
       .answer = list_scenarios,
       .query = list_query},
      {.method = "POST",
       .path = "/scenarios",
       .role = Role::model,
       .summary =
           "A new operating point; boundary conditions as 'name [unit]', all of the model's where one is open",
       .answers = {{201, "kept; `verdict` marks what lies outside the trained range"},
                   {409, "the name is taken, or the key was used for another request"},
                   {422, "no furnace can have it, or it is no scenario; the first is in quarantine"}},
       .answer = add_scenario,
       .body = BodyKind::json,
       .example = example,
       .wrong = wrong,
       .required = {"name", "inputs"},
       .keyed = true},
      {.method = "GET",
       .path = "/scenarios/{id}",
       .role = Role::reader,
       .summary = "One operating point",
       .answers = {{200, "it"}},
       .answer = one_scenario,
       .tagged = true},
      {.method = "PUT",
       .path = "/scenarios/{id}",
       .role = Role::model,
       .summary = "Changes an operating point; runs that were asked for before keep their inputs",
       .answers = {{200, "changed"}},
       .answer = change,
       .body = BodyKind::json,
       .example = example,
       .wrong = wrong,
       .required = {"name", "inputs"},
       .keyed = true,
       .locked = true},
      {.method = "GET",
       .path = "/scenarios/{id}/results",
       .role = Role::reader,
       .summary = "What the models made of it",
       .answers = {{200, "a part of the list"}, {400, "a query that is none"}},
       .answer = results,
       .query = list_query},
      {.method = "GET",
       .path = "/quarantine",
       .role = Role::reader,
       .summary = "What was sent and is wrong, each with the reason",
       .answers = {{200, "a part of the list"}, {400, "a query that is none"}},
       .answer = quarantine,
       .query = list_query},
      {.method = "GET",
       .path = "/quarantine/{id}",
       .role = Role::reader,
       .summary = "One of them",
       .answers = {{200, "it"}},
       .answer = quarantined}};
}

}  // namespace elrom::serve
