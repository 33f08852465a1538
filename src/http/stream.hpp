#pragma once
// A connection, plain or encrypted, as Beast needs it; for the sources of server and client alone.
//
// What Beast builds upon a connection takes seconds to compile, so it is built once, upon this class: the two
// kinds meet where some bytes are read or written.

#include <array>
#include <boost/asio.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

namespace elrom::http {

namespace asio = boost::asio;
namespace beast = boost::beast;

using Tcp = asio::ip::tcp;

inline std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<long long>(seconds * 1000));
}

class Stream {
 public:
  using executor_type = beast::tcp_stream::executor_type;
  using Done = std::function<void(beast::error_code)>;

  /// @param socket a connected one, or the io_context of one to connect @param tls null: plain; lives longer
  template <class Socket>
  Stream(Socket&& socket, asio::ssl::context* tls) {
    if (tls != nullptr)
      secure_ = std::make_unique<Secure>(std::forward<Socket>(socket), *tls);
    else
      plain_.emplace(std::forward<Socket>(socket));
  }

  [[nodiscard]] bool is_secure() const { return secure_ != nullptr; }
  [[nodiscard]] beast::tcp_stream& tcp() { return secure_ ? beast::get_lowest_layer(*secure_) : *plain_; }
  [[nodiscard]] executor_type get_executor() { return tcp().get_executor(); }

  // Of an encrypted one.
  [[nodiscard]] SSL* tls() { return secure_->native_handle(); }
  void async_handshake(asio::ssl::stream_base::handshake_type side, Done done);
  void async_shutdown(Done done);

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    read_some(first_of<asio::mutable_buffer>(buffers), shared(std::forward<Handler>(handler)));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    write_some(first_of<asio::const_buffer>(buffers), shared(std::forward<Handler>(handler)));
  }

 private:
  using Secure = beast::ssl_stream<beast::tcp_stream>;
  using SomeDone = std::function<void(beast::error_code, std::size_t)>;
  /// Some may be read or written, so it need not be all of them; the rest are empty.
  template <class Buffer>
  using Some = std::array<Buffer, 8>;

  template <class Buffer, class Buffers>
  static Some<Buffer> first_of(const Buffers& buffers) {
    Some<Buffer> some;
    std::size_t n = 0;
    for (auto at = asio::buffer_sequence_begin(buffers); at != asio::buffer_sequence_end(buffers); ++at) {
      const Buffer buffer(*at);
      if (buffer.size() > 0) some[n++] = buffer;
      if (n == some.size()) break;
    }
    return some;
  }
  /// A handler that can only be moved, as one that can be copied.
  template <class Handler>
  static SomeDone shared(Handler&& handler) {
    auto held = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
    return [held](beast::error_code fault, std::size_t n) { std::move (*held)(fault, n); };
  }
  void read_some(const Some<asio::mutable_buffer>& buffers, SomeDone done);
  void write_some(const Some<asio::const_buffer>& buffers, SomeDone done);

  std::optional<beast::tcp_stream> plain_;
  std::unique_ptr<Secure> secure_;
};

}  // namespace elrom::http
