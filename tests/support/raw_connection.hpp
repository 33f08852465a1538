#pragma once
// A TCP connection to this machine on which a test may send whatever it likes.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>

namespace elrom::test {

class RawConnection {
 public:
  explicit RawConnection(unsigned short port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<sockaddr*>(&place), sizeof place) != 0)
      throw std::runtime_error("cannot connect");
  }
  ~RawConnection() { ::close(socket_); }
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  /// @return false when the other end is gone
  bool send(std::string_view text) const {
    while (!text.empty()) {
      const auto n = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (n <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
  }
  void end_sending() const { ::shutdown(socket_, SHUT_WR); }

  /// All that comes until the other end closes or `seconds` are over.
  [[nodiscard]] std::string read_all(double seconds = 10) {
    std::string text;
    while (wait(seconds)) {
      char bytes[4096];
      const auto n = ::recv(socket_, bytes, sizeof bytes, 0);
      if (n <= 0) {
        closed_ = true;
        break;
      }
      text.append(bytes, static_cast<std::size_t>(n));
    }
    return text;
  }
  /// Whether read_all() saw the end.
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  [[nodiscard]] bool wait(double seconds) const {
    pollfd one{socket_, POLLIN, 0};
    return ::poll(&one, 1, static_cast<int>(seconds * 1000)) > 0;
  }

  int socket_;
  bool closed_ = false;
};

}  // namespace elrom::test
