#pragma once
// One connection of the server: reads a request within its limits, has the handler answer it, writes the
// answer. Internal to http.

#include <atomic>
#include <limits>

#include "elrom/http/server.hpp"
#include "rate_limiter.hpp"
#include "stream.hpp"

namespace elrom::http {

using Clock = std::chrono::steady_clock;

inline double seconds_now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

/// A header of ours must not become two.
inline std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text;
}

/// Bytes that all requests at work may hold together. Thread rule: any thread.
class Budget {
 public:
  explicit Budget(std::size_t bytes) : left_(bytes) {}
  bool take(std::size_t bytes) {
    auto left = left_.load();
    while (left >= bytes)
      if (left_.compare_exchange_weak(left, left - bytes)) return true;
    return false;
  }
  void give_back(std::size_t bytes) { left_ += bytes; }

 private:
  std::atomic<std::size_t> left_;
};

/// What all connections share.
struct Shared {
  const ServerOptions& options;
  Handler& handler;
  asio::thread_pool& workers;
  RateLimiter limiter;
  Budget budget;
  std::atomic<bool> stopping = false;
};

/// What a server refuses before a handler sees it.
struct Refused {
  int status;
  Problem problem;
  int retry_after_s = 0;
};

/// One connection. Everything but the handler's work happens on the thread of the io_context.
class Session : public std::enable_shared_from_this<Session> {
 public:
  /// @param left called when the connection is gone @param tls null: plain
  Session(Shared& shared, std::string client, std::function<void(Session*)> left, Tcp::socket socket,
          asio::ssl::context* tls)
      : shared_(shared),
        client_(std::move(client)),
        left_(std::move(left)),
        stream_(std::move(socket), tls),
        buffer_(limits().header_bytes) {}
  ~Session() { left_(this); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void begin() {
    if (!stream_.is_secure()) return await_request(limits().header_seconds);
    tcp().expires_after(milliseconds(limits().header_seconds));
    stream_.async_handshake(asio::ssl::stream_base::server, [self = self()](beast::error_code fault) {
      if (!fault) self->await_request(self->limits().header_seconds);
    });
  }

  void close_if_idle() {
    if (idle_) tcp().close();
  }

 private:
  [[nodiscard]] const Limits& limits() const { return shared_.options.limits; }
  [[nodiscard]] std::shared_ptr<Session> self() { return shared_from_this(); }
  [[nodiscard]] beast::tcp_stream& tcp() { return stream_.tcp(); }

  void await_request(double seconds) {
    if (shared_.stopping) return close();
    if (buffer_.size() > 0) return read_header();  // the peer did not wait for the last answer
    idle_ = true;
    tcp().expires_after(milliseconds(seconds));
    stream_.async_read_some(buffer_.prepare(limits().header_bytes),
                            [self = self()](beast::error_code fault, std::size_t n) {
                              self->idle_ = false;
                              self->buffer_.commit(n);
                              if (!fault) self->read_header();
                            });
  }

  void read_header() {
    request_ = {};
    request_.client = client_;
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(limits().header_bytes));
    // Judged below, where the handler has seen what is asked; boost::none would refuse every body.
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
    tcp().expires_after(milliseconds(limits().header_seconds));
    beast::http::async_read_header(
        stream_, buffer_, *parser_,
        [self = self()](beast::error_code fault, std::size_t) { self->on_header(fault); });
  }

  void on_header(beast::error_code fault) {
    began_ = seconds_now();
    if (fault == beast::http::error::end_of_stream) return close();
    if (fault.category() == beast::http::make_error_code(beast::http::error::bad_method).category()) {
      const bool long_header =
          fault == beast::http::error::header_limit || fault == beast::http::error::buffer_overflow;
      return refuse({long_header ? 431 : 400,
                     {.what = long_header ? "header too long" : "no HTTP request",
                      .found = fault.message(),
                      .expected = long_header ? "at most " + std::to_string(limits().header_bytes) + " bytes"
                                              : "HTTP/1.1"}});
    }
    if (fault) return;
    take_head();
    if (const auto refused = judge_head()) return refuse(*refused);
    if (!has_body()) return answer();
    if (beast::iequals(parser_->get()[beast::http::field::expect], "100-continue")) return send_continue();
    read_body();
  }

  void take_head() {
    const auto& head = parser_->get();
    request_.method = std::string(head.method_string());
    head_only_ = request_.method == "HEAD";
    if (head_only_) request_.method = "GET";
    request_.target = std::string(head.target());
    for (const auto& field : head)
      request_.headers.emplace_back(std::string(field.name_string()), std::string(field.value()));
  }

  [[nodiscard]] bool has_body() const {
    return parser_->chunked() || parser_->content_length().value_or(0) > 0;
  }

  std::optional<Refused> judge_head() {
    if (const double wait = shared_.limiter.take(client_, began_); wait > 0) {
      return Refused{
          429,
          {.what = "too many requests",
           .expected = "at most " + std::to_string(std::lround(limits().requests_per_second)) + " a second"},
          static_cast<int>(std::ceil(wait))};
    }
    const auto coding = parser_->get()[beast::http::field::transfer_encoding];
    if (!coding.empty() && !beast::iequals(coding, "chunked"))
      return Refused{501, {.what = "transfer coding not known", .found = std::string(coding)}};
    if (!has_body()) return std::nullopt;
    return judge_body();
  }

  std::optional<Refused> judge_body() {
    const auto most = shared_.handler.body_limit(request_);
    const auto length = parser_->content_length();
    if (length && *length > most) return too_large(most);
    const std::size_t needed = length ? static_cast<std::size_t>(*length) : most;
    if (!shared_.budget.take(needed))
      return Refused{503, {.what = "too much is being uploaded at once", .advice = "try again later"}, 1};
    held_ = needed;
    parser_->body_limit(most);
    return std::nullopt;
  }

  static Refused too_large(std::size_t most) {
    return {413, {.what = "body too large", .expected = "at most " + std::to_string(most) + " bytes"}};
  }

  void send_continue() {
    static constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
    tcp().expires_after(milliseconds(limits().header_seconds));
    asio::async_write(stream_, asio::buffer(go_on), [self = self()](beast::error_code fault, std::size_t) {
      if (!fault) self->read_body();
    });
  }

  void read_body() {
    tcp().expires_after(milliseconds(limits().body_seconds));
    beast::http::async_read(stream_, buffer_, *parser_,
                            [self = self()](beast::error_code fault, std::size_t) { self->on_body(fault); });
  }

  void on_body(beast::error_code fault) {
    if (fault == beast::http::error::body_limit) return refuse(too_large(held_));
    if (fault == beast::http::error::partial_message) return give_back_budget();
    if (fault.category() == beast::http::make_error_code(beast::http::error::bad_method).category())
      return refuse({400, {.what = "broken body", .found = fault.message()}});
    if (fault) return give_back_budget();
    request_.body = std::move(parser_->get().body());
    answer();
  }

  void answer() {
    tcp().expires_never();
    // The worker hands the session on with the answer: its last owner is always on the io thread.
    asio::post(shared_.workers, [self = self()]() mutable {
      auto response = std::make_shared<Response>(self->shared_.handler.handle(self->request_));
      const auto executor = self->stream_.get_executor();
      asio::post(executor, [self = std::move(self), response] { self->write(std::move(*response), true); });
    });
  }

  void refuse(const Refused& refused) {
    auto response = shared_.handler.refuse(refused.status, refused.problem);
    if (refused.retry_after_s > 0)
      response.headers.emplace_back("Retry-After", std::to_string(refused.retry_after_s));
    // What follows in the connection is a body that nobody reads.
    write(std::move(response), refused.status == 429 && !has_body());
  }

  void write(Response response, bool may_go_on) {
    const bool keep = may_go_on && parser_->keep_alive() && !shared_.stopping;
    auto message = std::make_shared<beast::http::response<beast::http::string_body>>();
    message->result(static_cast<unsigned>(response.status));
    message->reason(std::string(reason_of(response.status)));
    message->version(11);
    message->keep_alive(keep);
    for (const auto& [name, value] : response.headers) message->insert(name, one_line(value));
    const std::size_t n = response.body.size();
    if (response.status != 204 && response.status != 304) message->content_length(n);
    if (!head_only_) message->body() = std::move(response.body);
    tcp().expires_after(milliseconds(limits().answer_seconds));
    beast::http::async_write(stream_, *message,
                             [self = self(), message, keep, n](beast::error_code fault, std::size_t) {
                               self->on_written(fault, static_cast<int>(message->result_int()), n, keep);
                             });
  }

  void on_written(beast::error_code fault, int status, std::size_t n, bool keep) {
    give_back_budget();
    shared_.handler.done({request_, status, n, seconds_now() - began_});
    if (fault) return;
    if (keep) return await_request(limits().idle_seconds);
    close();
  }

  void give_back_budget() { shared_.budget.give_back(std::exchange(held_, 0)); }

  /// The peer still sends, perhaps; a close at once would reset the connection and take our answer from it.
  void close() {
    constexpr double patience_s = 2;
    tcp().expires_after(milliseconds(patience_s));
    if (stream_.is_secure())
      return stream_.async_shutdown([self = self()](beast::error_code) { self->tcp().close(); });
    beast::error_code ignored;
    tcp().socket().shutdown(Tcp::socket::shutdown_send, ignored);
    drain();
  }

  void drain() {
    buffer_.clear();
    tcp().async_read_some(buffer_.prepare(limits().header_bytes),
                          [self = self()](beast::error_code fault, std::size_t) {
                            if (!fault) self->drain();
                          });
  }

  Shared& shared_;
  std::string client_;
  std::function<void(Session*)> left_;
  Stream stream_;
  beast::flat_buffer buffer_;
  std::optional<beast::http::request_parser<beast::http::string_body>> parser_;
  Request request_;
  std::size_t held_ = 0;  //!< of the budget
  double began_ = 0;
  bool head_only_ = false, idle_ = false;
};

}  // namespace elrom::http
