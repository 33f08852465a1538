#include "reports.hpp"

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/shell.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/repository/secret.hpp"
#include "elrom/repository/transaction.hpp"

namespace elrom::serve {

std::string Places::open(const std::filesystem::path& file) {
  const auto now = Clock::now();
  const std::scoped_lock lock(mutex_);
  std::erase_if(places_, [&](const auto& one) { return one.second.end < now; });
  auto secret = repository::random_secret();
  places_[repository::secret_hash(secret)] = {file,
                                              now + std::chrono::duration_cast<Clock::duration>(open_for_)};
  return secret;
}

std::optional<std::filesystem::path> Places::file(const std::string& secret) const {
  const std::scoped_lock lock(mutex_);
  const auto found = places_.find(repository::secret_hash(secret));
  if (found == places_.end() || found->second.end < Clock::now()) return std::nullopt;
  return found->second.file;
}

std::filesystem::path Reports::of(const std::filesystem::path& study, const study::Versions& versions,
                                  int number) const {
  const auto digest = [&](int one) { return model::BundleReader(versions.file(one)).digest(); };
  const auto answers = versions.current().value_or(number);
  const auto file = folder_ / ((number == answers ? "" : digest(answers) + "-") + digest(number) + ".html");
  if (!std::filesystem::exists(file)) make(study, versions, number, file);
  return file;
}

void Reports::make(const std::filesystem::path& study, const study::Versions& versions, int number,
                   const std::filesystem::path& file) const {
  constexpr double patience_s = 600;
  if (program_.empty())
    throw repository::NotFoundError(Problem{.what = "no report of version " + std::to_string(number),
                                            .advice = "elrom-report beside elrom-serve makes it"});
  std::filesystem::create_directories(folder_);
  std::optional<base::FileLock> alone;
  try {
    alone.emplace(folder_ / ".lock");
  } catch (const UsageError&) {
    throw repository::ConflictError(
        Problem{.what = "a report is being made", .advice = "ask again in a minute"});
  }
  std::vector<std::string> command{program_.string()};
  if (number == versions.current())
    command.insert(command.end(), {"accuracy", study.string()});
  else
    command.insert(command.end(), {"compare", study.string(), versions.file(number).string()});
  command.insert(command.end(), {"--html", file.string(), "--quiet"});
  const auto ended = base::run_program(command, {.listen = true, .seconds = patience_s});
  // That the other version is worse is a status of its own, and a report.
  if (!std::filesystem::exists(file))
    throw InputError(Problem{.what = "elrom-report made no report",
                             .where = "version " + std::to_string(number),
                             .found = ended.said.empty() ? ended.in_words() : ended.reason()});
}

}  // namespace elrom::serve
