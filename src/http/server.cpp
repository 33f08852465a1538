#include "elrom/http/server.hpp"

#include <fcntl.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "session.hpp"

namespace elrom::http {
namespace {

/// A program that is begun beside the server and outlives it would keep the port and its callers.
template <class Socket>
void keep_from_children(Socket& socket) {
  ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
}

asio::ssl::context tls_context(const ServerOptions& options) {
  asio::ssl::context context(asio::ssl::context::tls_server);
  context.set_options(asio::ssl::context::no_tlsv1 | asio::ssl::context::no_tlsv1_1 |
                      asio::ssl::context::default_workarounds);
  const auto load = [](const std::filesystem::path& path, const char* what, const auto& work) {
    beast::error_code fault;
    work(fault);
    if (fault)
      throw InputError(Problem{.what = std::string("cannot use the ") + what,
                               .where = path.string(),
                               .found = fault.message(),
                               .expected = "PEM"});
  };
  load(options.certificate, "certificate", [&](beast::error_code& fault) {
    context.use_certificate_chain_file(options.certificate.string(), fault);
  });
  load(options.key, "key", [&](beast::error_code& fault) {
    context.use_private_key_file(options.key.string(), asio::ssl::context::pem, fault);
  });
  return context;
}

Tcp::endpoint endpoint_of(const ServerOptions& options) {
  beast::error_code fault;
  const auto address = asio::ip::make_address(options.address, fault);
  if (fault)
    throw InputError(Problem{.what = "no address to listen at",
                             .found = "'" + options.address + "'",
                             .expected = "127.0.0.1, 0.0.0.0, ::1 ..."});
  return {address, options.port};
}

}  // namespace

struct Server::Impl {
  ServerOptions options;
  std::optional<asio::ssl::context> tls;
  std::unique_ptr<asio::thread_pool> workers;
  Shared shared;
  std::map<std::string, std::size_t> by_address;
  std::set<Session*> connections;
  std::mutex mutex;
  std::condition_variable none_left;
  std::size_t n_connections = 0;  //!< guarded by the mutex; the rest belongs to the io thread
  std::unique_ptr<asio::io_context> io = std::make_unique<asio::io_context>(1);
  using Work = asio::executor_work_guard<asio::io_context::executor_type>;
  std::optional<Work> work{io->get_executor()};  //!< also while every request is with a worker
  std::optional<Tcp::acceptor> acceptor;
  std::optional<asio::steady_timer> pause;
  unsigned short port = 0;
  std::thread thread;

  Impl(const ServerOptions& wanted, Handler& handler)
      : options(wanted),
        workers(std::make_unique<asio::thread_pool>(static_cast<std::size_t>(std::max(1, wanted.threads)))),
        shared{options, handler, *workers,
               RateLimiter(options.limits.requests_per_second, options.limits.burst),
               Budget(options.limits.all_bodies_bytes)} {
    if (!options.certificate.empty() || !options.key.empty()) tls.emplace(tls_context(options));
    listen();
    accept();
    thread = std::thread([this] { io->run(); });
  }

  void listen() {
    const auto endpoint = endpoint_of(options);
    acceptor.emplace(*io);
    pause.emplace(*io);
    acceptor->open(endpoint.protocol());
    keep_from_children(*acceptor);
    acceptor->set_option(asio::socket_base::reuse_address(true));
    beast::error_code fault;
    acceptor->bind(endpoint, fault);
    if (!fault) acceptor->listen(asio::socket_base::max_listen_connections, fault);
    if (fault)
      throw SystemError(Problem{.what = "cannot listen",
                                .where = options.address + ":" + std::to_string(options.port),
                                .found = fault.message(),
                                .advice = "choose another port"});
    port = acceptor->local_endpoint().port();
  }

  void accept() {
    acceptor->async_accept([this](beast::error_code fault, Tcp::socket socket) {
      if (fault == asio::error::operation_aborted || shared.stopping) return;
      if (fault) return accept_later();
      keep_from_children(socket);
      begin(std::move(socket));
      accept();
    });
  }

  /// Out of descriptors: what is open may end.
  void accept_later() {
    pause->expires_after(std::chrono::milliseconds(100));
    pause->async_wait([this](beast::error_code fault) {
      if (!fault) accept();
    });
  }

  void begin(Tcp::socket socket) {
    beast::error_code fault;
    const auto client = socket.remote_endpoint(fault).address().to_string();
    const auto known = by_address.find(client);
    const std::size_t of_client = known == by_address.end() ? 0 : known->second;
    if (fault || connections.size() >= options.limits.connections ||
        of_client >= options.limits.connections_of_one)
      return;  // closed with the socket
    socket.set_option(Tcp::no_delay(true), fault);
    by_address[client] = of_client + 1;
    const auto left = [this, client](Session* gone) { forget(gone, client); };
    const auto connection =
        std::make_shared<Session>(shared, client, left, std::move(socket), tls ? &*tls : nullptr);
    connections.insert(connection.get());
    count();
    connection->begin();
  }

  void forget(Session* gone, const std::string& client) {
    connections.erase(gone);
    const auto found = by_address.find(client);
    if (found != by_address.end() && --found->second == 0) by_address.erase(found);
    count();
  }

  void count() {
    const std::scoped_lock lock(mutex);
    n_connections = connections.size();
    if (n_connections == 0) none_left.notify_all();
  }

  void stop(double grace_seconds) {
    if (!thread.joinable()) return;
    shared.stopping = true;
    asio::post(*io, [this] {
      acceptor->close();
      pause->cancel();
      const auto all = connections;
      for (auto* connection : all) connection->close_if_idle();
    });
    {
      std::unique_lock lock(mutex);
      none_left.wait_for(lock, milliseconds(grace_seconds), [this] { return n_connections == 0; });
    }
    io->stop();
    thread.join();
    workers->stop();
    workers->join();
    // What is left of connections goes while we are whole.
    workers.reset();
    work.reset();
    acceptor.reset();
    pause.reset();
    io.reset();
  }
};

Server::Server(const ServerOptions& options, Handler& handler)
    : impl_(std::make_unique<Impl>(options, handler)) {}
Server::~Server() { stop(0); }
unsigned short Server::port() const { return impl_->port; }
void Server::stop(double grace_seconds) { impl_->stop(grace_seconds); }

}  // namespace elrom::http
