#include <algorithm>
#include <atomic>
#include <span>

#include "desk.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/model/prediction_file.hpp"
#include "prediction_answer.hpp"
#include "problem.hpp"

namespace elrom::serve {
namespace {

using repository::Role;
using repository::Transaction;

std::string tag_of(const std::string& digest) { return "\"" + digest + "\""; }

http::Response known(const std::string& digest, int status) {
  auto response = json_response({{"digest", digest}}, status);
  response.headers.emplace_back("ETag", tag_of(digest));
  response.headers.emplace_back("Location", "/fields/" + digest);
  return response;
}

/// Looked at by another process, beside its place, before it gets there. Removed at the end.
class Upload {
 public:
  Upload(Desk& desk, const std::string& bytes, const std::string& digest)
      : desk_(desk), folder_(desk.options.repository.folder / "incoming") {
    std::filesystem::create_directories(folder_);
    static std::atomic<int> counter{0};
    file_ = folder_ / (digest + "." + std::to_string(counter++) + ".hdf");
    base::write_text(file_, bytes);
  }
  ~Upload() {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  /// @throws InputError that does not say where on this machine it lay
  void judge() const {
    const auto model = desk_.model.now();
    try {
      desk_.options.judge_upload(file_, model ? model->file() : std::filesystem::path());
    } catch (const InputError& error) {
      std::string reason = error.what();
      for (const auto& name : {file_.string(), file_.filename().string()})
        if (const auto at = reason.find(name); at != std::string::npos)
          reason.replace(at, name.size(), "the upload");
      throw InputError(reason);
    }
  }
  /// For people to look at.
  [[nodiscard]] std::string put_aside(const std::string& digest) const {
    const auto folder = desk_.options.repository.folder / "quarantine";
    std::filesystem::create_directories(folder);
    std::filesystem::rename(file_, folder / (digest + ".hdf"));
    return "quarantine/" + digest + ".hdf";
  }

 private:
  Desk& desk_;
  std::filesystem::path folder_, file_;
};

http::Response put_aside(Desk& desk, const Ask& ask, const Upload& upload, const InputError& fault) {
  const auto& digest = ask.parameters[0];
  const Json document{{"file", upload.put_aside(digest)}, {"bytes", ask.request.body.size()}};
  std::string place;
  desk.repository.write([&](Transaction& transaction) {
    const auto kept = transaction.quarantine(
        {.kind = "fields", .document = document.dump(), .reason = fault.what(), .by = ask.caller.name});
    place = "/quarantine/" + std::to_string(kept.id);
  });
  auto response = problem_response(fault);
  auto problem = Json::parse(response.body);
  problem["quarantine"] = place;
  response.body = problem.dump() + "\n";
  return response;
}

/// The digest is the key: however often it comes, the file is there once.
http::Response put(Desk& desk, const Ask& ask) {
  const auto& digest = ask.parameters[0];
  const auto& bytes = ask.request.body;
  if (!repository::is_digest(digest))
    throw repository::NotFoundError(Problem{.what = "no digest", .expected = "64 hexadecimal digits"});
  if (const auto found = base::sha256(std::as_bytes(std::span(bytes))); found != digest)
    throw InputError(Problem{.what = "the body is not what its digest says",
                             .found = found,
                             .expected = digest,
                             .advice = "it was changed or cut on its way: send it again"});
  bool there = false;
  desk.repository.read([&](Transaction& transaction) { there = transaction.fields(digest).has_value(); });
  if (there) return known(digest, 200);
  const Upload upload(desk, bytes, digest);
  try {
    upload.judge();
  } catch (const InputError& fault) {
    return put_aside(desk, ask, upload, fault);
  }
  (void)desk.repository.fields().put(bytes);
  desk.repository.write([&](Transaction& transaction) {
    transaction.know(
        {.digest = digest, .bytes = static_cast<std::int64_t>(bytes.size()), .by = ask.caller.name});
  });
  return known(digest, 201);
}

/// A request's digest. @throws NotFoundError
const std::string& kept_digest(Desk& desk, const Ask& ask) {
  const auto& digest = ask.parameters[0];
  bool there = false;
  desk.repository.read([&](Transaction& transaction) { there = transaction.fields(digest).has_value(); });
  if (there) return digest;
  throw repository::NotFoundError(Problem{.what = "no such fields", .found = "'" + digest + "'"});
}

http::Response get(Desk& desk, const Ask& ask) {
  const auto& digest = kept_digest(desk, ask);
  if (auto known = known_already(ask.request, tag_of(digest))) return std::move(*known);
  return {.headers = {{"ETag", tag_of(digest)},
                      {"Content-Type", "application/x-hdf5"},
                      {"Cache-Control", "private, max-age=31536000, immutable"}},
          .body = desk.repository.fields().read(digest)};
}

/// The file is read here only after a process of its own has read it, when it came.
http::Response cut_fields(Desk& desk, const Ask& ask) {
  const auto& digest = kept_digest(desk, ask);
  const auto model = open_model(desk);
  const auto wanted = cut_in_query(ask, model->cuts());
  model::StoredPrediction stored;
  {
    const std::scoped_lock lock(desk.hdf5);
    stored = model::read_prediction(desk.repository.fields().path(digest));
  }
  // A part of the furnace, and a digest that only says so, have other numbers of values.
  const bool same = stored.mesh_digest == model->bundle().mesh_digest() &&
                    std::ranges::all_of(stored.fields, [&](const auto& field) {
                      return field.values.size() == model->n_cells();
                    });
  std::optional<std::vector<std::int32_t>> cells;
  if (same) cells = model->cuts().cells(wanted);
  return {.headers = {{"Content-Type", "application/octet-stream"}},
          .body = cut_answer(wanted, stored, cells)};
}

}  // namespace

std::vector<Route> field_routes() {
  return {{.method = "GET",
           .path = "/fields/{digest}",
           .role = Role::reader,
           .summary = "A file of fields, HDF5",
           .answers = {{200, "the file"}},
           .answer = get,
           .media = {"application/x-hdf5"},
           .tagged = true},
          {.method = "GET",
           .path = "/fields/{digest}/cut",
           .role = Role::reader,
           .summary = "Fields of the file where a plane cut goes through the model's mesh, in the order of "
                      "GET /mesh/cut; `fields` is null when it is on another mesh",
           .answers = {{200, "a JSON header and the numbers, framed as POST /predictions does"},
                       {400, "no such cut"}},
           .answer = cut_fields,
           .query = {{"axis", "x, y or z"}, {"at", "where on it [m]"}},
           .media = {"application/octet-stream"}},
          {.method = "PUT",
           .path = "/fields/{digest}",
           .role = Role::model,
           .summary = "Keeps a file of fields (kind elrom-prediction) under its SHA-256",
           .answers = {{200, "it was here already"},
                       {201, "kept"},
                       {422, "another digest, or no fields of a furnace; the second is in quarantine"}},
           .answer = put,
           .body = BodyKind::hdf}};
}

}  // namespace elrom::serve
