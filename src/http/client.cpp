#include "elrom/http/client.hpp"

#include <limits>

#include "elrom/base/error.hpp"
#include "stream.hpp"

namespace elrom::http {
struct Url {
  bool secure = false;
  std::string host, port;
};

static Url parse_url(const std::string& text) {
  Url url{.secure = text.starts_with("https://")};
  if (!url.secure && !text.starts_with("http://"))
    throw UsageError(
        Problem{.what = "no address of a server", .found = "'" + text + "'", .expected = "http://host:port"});
  auto rest = text.substr(url.secure ? 8 : 7);
  rest = rest.substr(0, rest.find('/'));
  const auto colon = rest.rfind(':');
  const bool bracketed = rest.starts_with('[');
  const bool has_port = colon != std::string::npos && (!bracketed || colon > rest.find(']'));
  url.host = rest.substr(0, has_port ? colon : std::string::npos);
  if (bracketed) url.host = url.host.substr(1, url.host.size() - 2);
  url.port = has_port ? rest.substr(colon + 1) : (url.secure ? "443" : "80");
  if (url.host.empty() || url.port.empty())
    throw UsageError(
        Problem{.what = "no address of a server", .found = "'" + text + "'", .expected = "http://host:port"});
  return url;
}

struct Client::Impl {
  Url url;
  ClientOptions options;
  asio::io_context io{1};
  std::unique_ptr<asio::ssl::context> tls;
  std::optional<Stream> stream;
  beast::flat_buffer buffer;

  void disconnect() {
    stream.reset();
    buffer.clear();
  }

  [[noreturn]] void fail(const char* what, const beast::error_code& fault) {
    disconnect();
    throw SystemError(Problem{.what = what, .where = url.host + ":" + url.port, .found = fault.message()});
  }

  /// Runs what was begun to its end.
  void run(const char* what, const beast::error_code& fault) {
    io.restart();
    io.run();
    if (fault) fail(what, fault);
  }

  void connect() {
    beast::error_code fault;
    asio::ip::tcp::resolver resolver(io);
    const auto places = resolver.resolve(url.host, url.port, fault);
    if (fault) fail("cannot find the server", fault);
    if (url.secure) make_tls();
    stream.emplace(io, tls.get());
    stream->tcp().expires_after(milliseconds(options.timeout_seconds));
    stream->tcp().async_connect(places, [&](beast::error_code got, const auto&) { fault = got; });
    run("cannot reach the server", fault);
    expect_another();
    stream->tcp().socket().set_option(Tcp::no_delay(true), fault);
    if (!stream->is_secure()) return;
    SSL_set_tlsext_host_name(stream->tls(), url.host.c_str());
    stream->async_handshake(asio::ssl::stream_base::client, [&](beast::error_code got) { fault = got; });
    run("no trust in the server's certificate", fault);
  }

  /// Where nobody listens at a port that the system gives to callers, who calls may get that very port and
  /// meet himself; the server could then not come back to it.
  void expect_another() {
    beast::error_code fault;
    auto& socket = stream->tcp().socket();
    if (socket.local_endpoint(fault) == socket.remote_endpoint(fault))
      fail("cannot reach the server", asio::error::connection_refused);
  }

  void make_tls() {
    tls = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_client);
    beast::error_code fault;
    if (options.authority.empty())
      tls->set_default_verify_paths(fault);
    else
      tls->load_verify_file(options.authority.string(), fault);
    if (fault) fail("cannot use the certificates of authorities", fault);
    tls->set_verify_mode(asio::ssl::verify_peer);
    tls->set_verify_callback(asio::ssl::host_name_verification(url.host));
  }

  /// Whether the server closed the connection since the last answer.
  [[nodiscard]] bool is_stale() {
    auto& socket = stream->tcp().socket();
    beast::error_code fault;
    socket.non_blocking(true, fault);
    char byte = 0;
    socket.receive(asio::buffer(&byte, 1), asio::socket_base::message_peek, fault);
    return fault != asio::error::would_block;
  }

  Response send(const Request& request) {
    if (stream && is_stale()) disconnect();
    if (!stream) connect();
    write(request);
    return read(request.method == "HEAD");
  }

  void write(const Request& request) {
    beast::http::request<beast::http::string_body> message;
    message.method_string(request.method);
    message.target(request.target);
    message.version(11);
    message.set(beast::http::field::host, url.host);
    for (const auto& [name, value] : request.headers) message.set(name, value);
    message.body() = request.body;
    message.prepare_payload();
    beast::error_code fault;
    stream->tcp().expires_after(milliseconds(options.timeout_seconds));
    beast::http::async_write(*stream, message, [&](beast::error_code got, std::size_t) { fault = got; });
    run("the request could not be sent", fault);
  }

  Response read(bool head_only) {
    beast::http::response_parser<beast::http::string_body> parser;
    parser.body_limit(options.answer_bytes);
    parser.skip(head_only);
    beast::error_code fault;
    beast::http::async_read(*stream, buffer, parser,
                            [&](beast::error_code got, std::size_t) { fault = got; });
    run("no whole answer came", fault);
    auto& message = parser.get();
    Response response{.status = static_cast<int>(message.result_int()), .body = std::move(message.body())};
    for (const auto& field : message)
      response.headers.emplace_back(std::string(field.name_string()), std::string(field.value()));
    if (!parser.keep_alive()) disconnect();
    return response;
  }
};

Client::Client(const std::string& url, ClientOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->url = parse_url(url);
  impl_->options = std::move(options);
}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Response Client::send(const Request& request) { return impl_->send(request); }

}  // namespace elrom::http
