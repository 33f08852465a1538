#include "elrom/http/server.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <thread>

#include "elrom/base/random.hpp"
#include "elrom/http/client.hpp"
#include "support/outcome.hpp"
#include "support/raw_connection.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::http {
namespace {

using test::RawConnection;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Answers with what it was asked; "/slow" after a moment.
class Echo : public Handler {
 public:
  [[nodiscard]] std::size_t body_limit(const Request& head) const override {
    return head.target == "/large" ? std::size_t{1} << 22 : 1000;
  }
  [[nodiscard]] Response handle(const Request& request) override {
    if (request.target == "/slow") std::this_thread::sleep_for(std::chrono::milliseconds(300));
    ++n_handled;
    return {.status = 200,
            .headers = {{"X-Method", request.method}, {"X-Evil", "a\r\nSet-Cookie: b"}},
            .body = request.target + "|" + request.body};
  }
  [[nodiscard]] Response refuse(int status, const Problem& problem) override {
    return {.status = status, .headers = {}, .body = problem.message()};
  }
  void done(const Exchange& exchange) override {
    const std::scoped_lock lock(mutex);
    statuses.push_back(exchange.status);
  }

  std::atomic<int> n_handled = 0;
  std::mutex mutex;
  std::vector<int> statuses;
};

struct Running {
  Echo echo;
  Server server;
  explicit Running(const Limits& limits = {}) : server({.threads = 4, .limits = limits}, echo) {}
  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(server.port()); }
  [[nodiscard]] std::string exchange(const std::string& bytes, double seconds = 5) const {
    RawConnection connection(server.port());
    connection.send(bytes);
    connection.end_sending();
    return connection.read_all(seconds);
  }
};

constexpr const char* chunked = "POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";

TEST(Server, AnswersOneConnectionAgainAndAgain) {
  Running running;
  Client client(running.url());

  for (int i = 0; i < 20; ++i) {
    const auto response = client.send({.method = "POST", .target = "/a?b", .body = std::to_string(i)});
    EXPECT_EQ(response.status, 200);
    EXPECT_EQ(response.body, "/a?b|" + std::to_string(i));
  }
}

TEST(Server, AHeadIsAnsweredWithoutTheBody) {
  Running running;
  Client client(running.url());

  const auto response = client.send({.method = "HEAD", .target = "/abc"});

  EXPECT_EQ(response.body, "");
  EXPECT_EQ(*response.header("Content-Length"), "5");
  EXPECT_EQ(*response.header("X-Method"), "GET");
}

TEST(Server, AHeaderOfOursCannotBecomeTwo) {
  Running running;

  const auto text = running.exchange("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");

  EXPECT_THAT(text,
              AllOf(HasSubstr("X-Evil: a  Set-Cookie: b\r\n"), ::testing::Not(HasSubstr("\nSet-Cookie"))));
}

TEST(Server, RequestsSentAheadAreAnsweredInOrder) {
  Running running;
  std::string ahead;
  for (int i = 0; i < 5; ++i) ahead += "GET /" + std::to_string(i) + " HTTP/1.1\r\nHost: x\r\n\r\n";

  const auto text = running.exchange(ahead);

  std::size_t at = 0;
  for (int i = 0; i < 5; ++i) {
    at = text.find("/" + std::to_string(i) + "|", at);
    EXPECT_NE(at, std::string::npos) << i;
  }
}

TEST(Server, AChunkedBodyIsPutTogether) {
  Running running;

  EXPECT_THAT(running.exchange(std::string(chunked) + "3\r\nabc\r\n2;x=y\r\nde\r\n0\r\n\r\n"),
              HasSubstr("/|abcde"));
}

TEST(Server, ABodyIsAskedForWhenTheClientWaits) {
  Running running;
  RawConnection connection(running.server.port());

  connection.send("POST / HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: 3\r\n\r\n");
  EXPECT_THAT(connection.read_all(0.3), StartsWith("HTTP/1.1 100 Continue"));
  connection.send("abc");

  EXPECT_THAT(connection.read_all(0.5), HasSubstr("/|abc"));
}

TEST(Server, WhatIsTooLargeIsRefusedBeforeItIsRead) {
  Running running;
  const std::string head = "POST / HTTP/1.1\r\nHost: x\r\n";

  EXPECT_THAT(running.exchange(head + "Content-Length: 1001\r\n\r\n"), StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(running.exchange(head + "Content-Length: 18446744073709551615\r\n\r\n"),
              StartsWith("HTTP/1.1 4"));
  EXPECT_THAT(running.exchange(std::string(chunked) + "3e9\r\n"), StartsWith("HTTP/1.1 413 "));
  std::string crumbs = chunked;
  for (int i = 0; i < 1001; ++i) crumbs += "1\r\na\r\n";
  EXPECT_THAT(running.exchange(crumbs), StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(running.exchange("GET / HTTP/1.1\r\nX: " + std::string(20000, 'x') + "\r\n\r\n"),
              StartsWith("HTTP/1.1 431 "));
  EXPECT_EQ(running.echo.n_handled, 0);
}

TEST(Server, ALineOrAChunkWithoutEndIsRefused) {
  Running running;

  EXPECT_THAT(running.exchange("GET /" + std::string(100000, 'a')), StartsWith("HTTP/1.1 4"));
  EXPECT_THAT(running.exchange(std::string(chunked) + "1;" + std::string(100000, 'x')),
              StartsWith("HTTP/1.1 4"));
  EXPECT_EQ(running.echo.n_handled, 0);
}

TEST(Server, WhatIsNoHttpIsRefused) {
  Running running;

  for (const char* text :
       {"\r\n\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "\x16\x03\x01\x02\x00\x01\x00\x01",
        "GET / HTTP/1.1\r\nHost : x\r\n\r\n", "POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
        "POST / HTTP/1.1\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n",
        "POST / HTTP/1.1\r\nContent-Length: 3\r\nContent-Length: 4\r\n\r\n",
        "POST / HTTP/1.1\r\nTransfer-Encoding: gzip\r\n\r\n"}) {
    const auto answer = running.exchange(text);
    EXPECT_TRUE(answer.empty() || answer.starts_with("HTTP/1.1 4") || answer.starts_with("HTTP/1.1 501"))
        << text;
  }
  EXPECT_EQ(running.echo.n_handled, 0);
}

TEST(Server, ATricklingHeaderIsCutOff) {
  Running running({.header_seconds = 0.3});
  RawConnection connection(running.server.port());

  bool there = connection.send("GET / HTTP/1.1\r\n");
  for (int i = 0; i < 20 && there; ++i) {  // a byte is never long in coming
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    there = connection.send("X");
  }

  EXPECT_FALSE(there);
  EXPECT_EQ(running.echo.n_handled, 0);
}

TEST(Server, ATricklingBodyIsCutOff) {
  Running running({.body_seconds = 0.3});
  RawConnection connection(running.server.port());

  bool there = connection.send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 900\r\n\r\n");
  for (int i = 0; i < 20 && there; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    there = connection.send("X");
  }

  EXPECT_FALSE(there);
  EXPECT_EQ(running.echo.n_handled, 0);
}

TEST(Server, AConnectionThatSaysNothingIsClosed) {
  Running running({.header_seconds = 0.2, .idle_seconds = 0.2});
  RawConnection quiet(running.server.port()), used(running.server.port());

  used.send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");

  EXPECT_EQ(quiet.read_all(3), "");
  EXPECT_TRUE(quiet.closed());
  EXPECT_THAT(used.read_all(3), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(used.closed());
}

TEST(Server, MoreRequestsThanTheRateAreToldToWait) {
  Running running({.requests_per_second = 1, .burst = 5});
  Client client(running.url());

  int n_answered = 0, n_refused = 0;
  for (int i = 0; i < 10; ++i) {
    const auto response = client.send({.method = "GET", .target = "/"});
    n_answered += response.status == 200;
    if (response.status == 429) {
      ++n_refused;
      EXPECT_EQ(*response.header("Retry-After"), "1");
    }
  }

  EXPECT_EQ(n_answered, 5);
  EXPECT_EQ(n_refused, 5);
}

TEST(Server, MoreConnectionsThanAllowedAreClosed) {
  Running running({.connections_of_one = 2});
  RawConnection first(running.server.port()), second(running.server.port());
  EXPECT_TRUE(first.send("GET / HTTP/1.1\r\nHost: x\r\n\r\n"));
  EXPECT_THAT(first.read_all(0.2), HasSubstr("/|"));
  RawConnection third(running.server.port());

  EXPECT_EQ(third.read_all(3), "");
  EXPECT_TRUE(third.closed());
  second.send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(second.read_all(0.3), HasSubstr("/|"));
}

TEST(Server, AClosedConnectionMakesRoomForAnother) {
  Running running({.connections_of_one = 2});
  for (int i = 0; i < 6; ++i)
    EXPECT_THAT(running.exchange("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"), HasSubstr("/|"))
        << i;
}

TEST(Server, BodiesTogetherHaveALimit) {
  Running running({.all_bodies_bytes = 1500});
  RawConnection first(running.server.port());
  first.send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 900\r\n\r\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));

  EXPECT_THAT(
      running.exchange("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 900\r\n\r\n" + std::string(900, 'b')),
      StartsWith("HTTP/1.1 503 "));
  first.send(std::string(900, 'a'));
  EXPECT_THAT(first.read_all(0.5), StartsWith("HTTP/1.1 200 "));
  // What was taken is given back.
  EXPECT_THAT(
      running.exchange("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 900\r\n\r\n" + std::string(900, 'b')),
      StartsWith("HTTP/1.1 200 "));
}

TEST(Server, StoppingLetsRequestsInWorkEnd) {
  auto running = std::make_unique<Running>();
  Client client(running->url());
  auto answer =
      std::async(std::launch::async, [&] { return client.send({.method = "GET", .target = "/slow"}); });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));

  running->server.stop(10);

  EXPECT_EQ(answer.get().body, "/slow|");
  EXPECT_ERROR(SystemError, "cannot reach the server",
               Client(running->url()).send({.method = "GET", .target = "/"}));
}

TEST(Server, StoppingDoesNotWaitForIdleOrHungConnections) {
  auto running = std::make_unique<Running>();
  RawConnection idle(running->server.port()), hung(running->server.port());
  hung.send("GET / HT");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto began = std::chrono::steady_clock::now();

  running->server.stop(0.5);

  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(3));
}

TEST(Server, APortThatIsTakenIsNamed) {
  const Running running;
  Echo echo;

  EXPECT_ERROR(SystemError, "cannot listen in 127.0.0.1:" + std::to_string(running.server.port()),
               Server({.port = running.server.port()}, echo));
}

TEST(Server, ManyClientsAtOnceAreAllAnswered) {
  Running running({.requests_per_second = 1e9, .burst = 1e9});
  std::atomic<int> n_right = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 16; ++t)
    threads.emplace_back([&, t] {
      Client client(running.url());
      for (int i = 0; i < 50; ++i) {
        const std::string body(static_cast<std::size_t>(t * 50 + i) % 900, 'x');
        n_right += client.send({.method = "POST", .target = "/", .body = body}).body == "/|" + body;
      }
    });
  for (auto& thread : threads) thread.join();

  EXPECT_EQ(n_right, 16 * 50);
}

TEST(Server, LargeBodiesGoBothWays) {
  Running running;
  Client client(running.url());
  const std::string body(std::size_t{1} << 22, 'x');

  EXPECT_EQ(client.send({.method = "POST", .target = "/large", .body = body}).body.size(), body.size() + 7);
}

/// A sound request with bytes changed, left out, doubled or put in.
std::string damaged(base::Random& random) {
  static const std::vector<std::string> sound{
      "GET /a/b?c=d HTTP/1.1\r\nHost: x\r\nAccept: */*\r\n\r\n",
      "POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nhello",
      std::string(chunked) + "5\r\nhello\r\n0\r\n\r\n",
      "PUT /x HTTP/1.0\r\nConnection: keep-alive\r\nContent-Length: 0\r\n\r\n"};
  static const std::string spice("\0\r\n :;\x7F\xFF%/?0fF-+\t", 18);
  auto text = sound[random.below(sound.size())];
  for (auto n = 1 + random.below(4); n > 0; --n) {
    const auto at = random.below(text.size());
    const char byte = spice[random.below(spice.size())];
    switch (random.below(5)) {
      case 0:
        text[at] = byte;
        break;
      case 1:
        text.erase(at, 1 + random.below(8));
        break;
      case 2:
        text.insert(at, 1, byte);
        break;
      case 3:
        text.insert(at, text.substr(at, random.below(20)));
        break;
      default:
        text[at] = static_cast<char>(random.below(256));
    }
    if (text.empty()) text = "\r";
  }
  return text;
}

TEST(Server, DamagedRequestsNeverStopIt) {
  Running running({.header_seconds = 0.5, .body_seconds = 0.5, .requests_per_second = 1e9, .burst = 1e9});
  base::Random random(base::Seed(19).derive("requests"));

  for (int i = 0; i < 2000; ++i) {
    const auto answer = running.exchange(damaged(random), 3);
    ASSERT_TRUE(answer.empty() || answer.starts_with("HTTP/1.1 ")) << i << ": " << answer;
  }

  EXPECT_EQ(Client(running.url()).send({.method = "GET", .target = "/end"}).body, "/end|");
}

TEST(Server, SpeaksTlsWhereACertificateIsGiven) {
  const test::TemporaryFolder folder;
  const auto certificate = folder / "server.pem", key = folder / "server.key";
  const auto made = test::outcome_of(
      "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=127.0.0.1 "
      "-addext subjectAltName=IP:127.0.0.1 -keyout '" +
      key.string() + "' -out '" + certificate.string() + "' 2>&1");
  if (made.status != 0) GTEST_SKIP() << "no openssl program: " << made.text;
  Echo echo;
  Server server({.certificate = certificate, .key = key}, echo);
  const auto port = std::to_string(server.port());

  Client trusting("https://127.0.0.1:" + port, {.authority = certificate});
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(trusting.send({.method = "POST", .target = "/", .body = "secret"}).body, "/|secret");
  EXPECT_ERROR(SystemError, "no trust",
               Client("https://127.0.0.1:" + port).send({.method = "GET", .target = "/"}));
  EXPECT_ERROR(SystemError, "", Client("http://127.0.0.1:" + port).send({.method = "GET", .target = "/"}));
}

TEST(Server, ACertificateThatCannotBeReadIsNamed) {
  Echo echo;

  EXPECT_ERROR(InputError, "cannot use the certificate in /nowhere.pem",
               Server({.certificate = "/nowhere.pem", .key = "/nowhere.key"}, echo));
}

TEST(Client, ABadAddressIsRefused) {
  EXPECT_ERROR(UsageError, "no address of a server: found 'ftp://x'", Client("ftp://x"));
  EXPECT_ERROR(UsageError, "no address of a server", Client("http://:80"));
}

TEST(Client, AnAddressInBracketsMayHaveAPort) {
  Running running;
  const auto port = std::to_string(running.server.port());
  // Nobody listens there: what matters is which port is tried.
  EXPECT_ERROR(SystemError, "::1:" + port,
               Client("http://[::1]:" + port).send({.method = "GET", .target = "/"}));
}

TEST(Client, GoesOnAfterItsServerWasStartedAgain) {
  auto running = std::make_unique<Running>();
  const auto port = running->server.port();
  Client client(running->url());
  EXPECT_EQ(client.send({.method = "GET", .target = "/"}).status, 200);
  running.reset();
  Echo echo;
  const Server again({.port = port}, echo);

  EXPECT_EQ(client.send({.method = "GET", .target = "/"}).status, 200);
}

TEST(Client, AnAnswerThatTakesTooLongIsGivenUp) {
  Running running;

  EXPECT_ERROR(SystemError, "no whole answer came",
               Client(running.url(), {.timeout_seconds = 0.1}).send({.method = "GET", .target = "/slow"}));
}

}  // namespace
}  // namespace elrom::http
