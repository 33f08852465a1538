#pragma once
// An HTTP/1.1 server behind one seam: whoever answers is a Handler and sees whole requests only. Everything
// that a stranger may send is limited before a handler sees it: size of header and body, the time for each,
// the time between two requests, requests a second, connections, and what all bodies on their way may hold
// together.
//
// Boost.Beast does the parsing. It was taken before cpp-httplib 0.11.4, which reads a header, a chunk or a
// body for as long as its peer trickles (its timeouts are of single reads), has no limit on a header's lines
// or on connections, and gives a thread to each connection; Beast leaves every one of these to us.
//
// Thread rule: a handler is called from several threads at once; Server's members from any thread.

#include <filesystem>
#include <memory>
#include <string>

#include "elrom/base/error.hpp"
#include "elrom/http/message.hpp"

namespace elrom::http {

struct Limits {
  std::size_t header_bytes = std::size_t{16} << 10;
  std::size_t all_bodies_bytes = std::size_t{512} << 20;  ///< of all requests that are being read or answered
  double header_seconds = 10;  ///< from the first look at the connection to the header's end
  double body_seconds = 60;    ///< for the whole body, however it comes
  double answer_seconds = 60;  ///< until the peer has taken the answer
  double idle_seconds = 60;    ///< between two requests of a connection
  std::size_t connections = 512;
  std::size_t connections_of_one = 128;  ///< of one address
  double requests_per_second = 500;      ///< of one address, in the long run
  double burst = 1000;                   ///< requests of one address at once
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  unsigned short port = 0;  ///< 0: any free one
  int threads = 8;          ///< that answer
  Limits limits;
  std::filesystem::path certificate, key;  ///< PEM; both or none: TLS 1.2 and later, or plain
};

/// What became of a request, for logs and counts.
struct Exchange {
  const Request& request;
  int status;
  std::size_t answer_bytes;
  double seconds;  ///< from the header's end to the answer's last byte
};

class Handler {
 public:
  virtual ~Handler() = default;
  /// Largest body that this request, of which only the head is there, may bring.
  [[nodiscard]] virtual std::size_t body_limit(const Request& head) const = 0;
  /// Must not throw.
  [[nodiscard]] virtual Response handle(const Request& request) = 0;
  /// What the server itself refuses, in the handler's words.
  [[nodiscard]] virtual Response refuse(int status, const Problem& problem) = 0;
  virtual void done(const Exchange& exchange) = 0;
};

class Server {
 public:
  /// Listens and answers at once. @throws InputError for an address, certificate or key that cannot be used;
  /// SystemError for a port that is taken
  Server(const ServerOptions& options, Handler& handler);
  ~Server();  ///< stop(0)
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] unsigned short port() const;
  /// Takes no new connection or request, lets those in work end, for at most so long, and closes.
  void stop(double grace_seconds);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::http
