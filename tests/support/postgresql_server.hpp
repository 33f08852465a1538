#pragma once
// A PostgreSQL server of a test's own, in a temporary folder, from Debian's package; it listens on a socket
// there and nowhere else. Where the package is missing, available() says no.

#include <pwd.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "support/temporary_folder.hpp"

namespace elrom::test {

class PostgresqlServer {
 public:
  PostgresqlServer() : folder_("/tmp") {
    give_away(folder_.path());
    copy_empty_data();
    start();
  }
  ~PostgresqlServer() { stop(SIGQUIT); }
  PostgresqlServer(const PostgresqlServer&) = delete;
  PostgresqlServer& operator=(const PostgresqlServer&) = delete;

  [[nodiscard]] static bool available() {
    return !binaries().empty() && (::getuid() != 0 || owner() != nullptr);
  }
  [[nodiscard]] std::string url() const {
    return "postgresql://elrom@/template1?host=" + folder_.path().string();
  }
  void start() {
    const std::vector<std::string> server{
        program("postgres"), "-D", data(),      "-k", folder_.path().string(), "-c",
        "listen_addresses=", "-c", "fsync=off", "-c", "max_connections=100"};
    const auto socket = folder_ / ".s.PGSQL.5432";
    for (int i = 0; i < 1200; ++i) {
      // It ends at once while workers of a killed one still hold their memory.
      if (process_ <= 0 || ::waitpid(process_, nullptr, WNOHANG) == process_) process_ = begin(server);
      if (std::filesystem::exists(socket) &&
          wait_for(begin({program("pg_isready"), "-q", "-h", folder_.path().string()})) == 0)
        return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    throw std::runtime_error("the PostgreSQL server does not start");
  }
  /// SIGKILL: as a crash would.
  void stop(int signal) {
    if (process_ <= 0) return;
    ::kill(process_, signal);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
    std::filesystem::remove(folder_ / ".s.PGSQL.5432");
  }

 private:
  /// Making an empty cluster costs more than most tests: the first is kept beside the test program, for
  /// those that follow.
  void copy_empty_data() {
    namespace fs = std::filesystem;
    const auto kept =
        fs::read_symlink("/proc/self/exe").parent_path() /
        ("postgresql-" + binaries().parent_path().filename().string() + "-of-" + std::to_string(::getuid()));
    if (!fs::exists(kept)) {
      make_empty_data();
      const fs::path mine = kept.string() + "." + std::to_string(::getpid());
      std::error_code not_kept;  // another was first, or nobody may write here: the next makes its own
      fs::remove_all(mine, not_kept);
      fs::copy(data(), mine, fs::copy_options::recursive, not_kept);
      if (!not_kept) fs::rename(mine, kept, not_kept);
      fs::remove_all(mine, not_kept);
      return;
    }
    fs::copy(kept, data(), fs::copy_options::recursive);
    give_away(data());
    for (const auto& entry : fs::recursive_directory_iterator(data())) give_away(entry.path());
  }
  /// With one database: the two others are two thirds of the files.
  void make_empty_data() {
    // Nothing is fetched from a disk that lost power here, so nothing is waited for.
    done(begin({program("initdb"), "-D", data(), "-U", "elrom", "-A", "trust", "-E", "UTF8", "--no-sync",
                "--no-instructions", "--locale=C", "--wal-segsize=1"}));
    start();
    done(begin({program("psql"), "-X", "-v", "ON_ERROR_STOP=1", "-h", folder_.path().string(), "-U", "elrom",
                "-d", "template1", "-c", "UPDATE pg_database SET datistemplate = false", "-c",
                "DROP DATABASE template0", "-c", "DROP DATABASE postgres"}));
    stop(SIGINT);
  }
  static void give_away(const std::filesystem::path& path) {
    const auto* user = owner();
    if (user != nullptr && ::chown(path.c_str(), user->pw_uid, user->pw_gid) != 0)
      throw std::runtime_error("cannot give " + path.string() + " away");
  }
  /// Who may run it: the server refuses to be root's.
  [[nodiscard]] static const passwd* owner() { return ::getuid() == 0 ? ::getpwnam("postgres") : nullptr; }
  [[nodiscard]] static std::filesystem::path binaries() {
    const std::filesystem::path all = "/usr/lib/postgresql";
    std::filesystem::path newest;
    std::error_code none;
    for (const auto& version : std::filesystem::directory_iterator(all, none))
      if (std::filesystem::exists(version.path() / "bin/initdb") && version.path() > newest)
        newest = version.path();
    return newest.empty() ? newest : newest / "bin";
  }
  [[nodiscard]] static std::string program(const char* name) { return (binaries() / name).string(); }
  [[nodiscard]] std::string data() const { return (folder_ / "data").string(); }

  [[nodiscard]] pid_t begin(const std::vector<std::string>& command) const {
    const auto* user = owner();
    const auto log = (folder_ / "log.txt").string();
    std::fflush(nullptr);  // or the child writes what is ours once more
    const pid_t child = ::fork();
    if (child != 0) return child;
    if (user != nullptr && (::setgid(user->pw_gid) != 0 || ::setuid(user->pw_uid) != 0)) ::_exit(126);
    std::vector<char*> arguments;
    for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (std::freopen(log.c_str(), "a", stdout) == nullptr || ::dup2(1, 2) < 0 || ::chdir("/tmp") != 0)
      ::_exit(125);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  void done(pid_t process) const {
    if (wait_for(process) != 0)
      throw std::runtime_error("no PostgreSQL cluster: " + read_bytes(folder_ / "log.txt"));
  }
  static int wait_for(pid_t process) {
    int status = 0;
    ::waitpid(process, &status, 0);
    return status;
  }

  TemporaryFolder folder_;
  pid_t process_ = -1;
};

}  // namespace elrom::test
