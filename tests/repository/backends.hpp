#pragma once
// The same tests on every database that the repository may lie in.

#include <gmock/gmock.h>

#include <memory>
#include <string>

#include "database.hpp"
#include "elrom/repository/repository.hpp"
#include "support/postgresql_server.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::repository {

using ModelRun = Run;  ///< inside a test, Run is what runs it

/// A repository in a folder of its own, on the database that the parameter names.
class EachDatabase : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (GetParam() != "postgresql") return;
    if (!ELROM_HAS_POSTGRESQL || !test::PostgresqlServer::available())
      GTEST_SKIP() << "no PostgreSQL in this build or on this machine";
    // One server for all tests of this process, and an empty database for each.
    static test::PostgresqlServer server;
    const auto connection = make_postgresql_backend(server.url())->connect();
    connection->query("DROP SCHEMA public CASCADE", {});
    connection->query("CREATE SCHEMA public", {});
    server_ = &server;
  }
  [[nodiscard]] RepositoryOptions options() {
    return {.folder = folder_ / "store", .database = server_ ? server_->url() : "sqlite", .clock = [this] {
              return now_;
            }};
  }
  [[nodiscard]] Repository& repository() {
    if (!repository_) repository_ = std::make_unique<Repository>(options());
    return *repository_;
  }
  void close() { repository_.reset(); }

  test::TemporaryFolder folder_;
  test::PostgresqlServer* server_ = nullptr;
  double now_ = 1000;  //!< what the repository's clock says

 private:
  std::unique_ptr<Repository> repository_;
};

#define ELROM_ON_EACH_DATABASE(Suite)                                                                    \
  INSTANTIATE_TEST_SUITE_P(, Suite, ::testing::Values(std::string("sqlite"), std::string("postgresql")), \
                           [](const auto& one) { return one.param; })

inline Scenario sample_scenario(const std::string& name) {
  return {.name = name,
          .boiler = "Lagisza",
          .note = "full load, \xC5\x81\xC3\xB3\x64\xC5\xBA 'quoted'",
          .load = 0.1 + 0.2,
          .inputs = R"({"primary_air [kg/s]":161.1})",
          .verdict = "inside",
          .reason = "like the others",
          .by = "tester"};
}

}  // namespace elrom::repository
