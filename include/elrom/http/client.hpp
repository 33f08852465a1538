#pragma once
// A blocking HTTP/1.1 client: one connection, kept open between requests, one limit of time for each of them.
//
// Thread rule: one thread at a time.

#include <filesystem>
#include <memory>
#include <string>

#include "elrom/http/message.hpp"

namespace elrom::http {

struct ClientOptions {
  double timeout_seconds = 30;                      ///< from connecting to the answer's last byte
  std::size_t answer_bytes = std::size_t{1} << 30;  ///< more is refused
  std::filesystem::path authority;  ///< PEM of who vouches for the server; empty: the system's
};

class Client {
 public:
  /// @param url "http://host:port" or "https://host:port"; connects when first used. @throws UsageError
  explicit Client(const std::string& url, ClientOptions options = {});
  ~Client();
  Client(Client&&) noexcept;

  /// Not tried again here: whether the server saw it, its own key must tell.
  /// @throws SystemError when no whole answer came; the next request connects anew
  [[nodiscard]] Response send(const Request& request);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::http
