// elrom-serve as a machine meets it: started, asked, killed, stopped.
#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/http/client.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/outcome.hpp"
#include "support/raw_connection.hpp"
#include "support/sample_bundle.hpp"
#include "support/serving.hpp"
#include "support/temporary_folder.hpp"
#include "support/tiny_disk.hpp"

namespace elrom::serve {
namespace {

using Json = nlohmann::json;
using test::outcome_of;
using test::Serving;
using ::testing::HasSubstr;

const std::string program = ELROM_BIN_DIR "/elrom-serve";

struct Started {
  test::TemporaryFolder folder;
  test::TinyDisk disk{folder / "disk", "4m"};
  std::string data = (folder / "disk/data").string();
  std::string token = base::trim(outcome_of(program + " --data " + data + " --make-token me=admin").text);
  std::unique_ptr<Serving> serving;

  Started() {
    test::sample_bundle({}).write(folder / "model.elrom");
    serving = std::make_unique<Serving>(
        program,
        std::vector<std::string>{"--data", data, "--model", (folder / "model.elrom").string(), "--quiet"});
  }
  http::Response call(const std::string& method, const std::string& target, const std::string& body = "",
                      const std::string& key = "k", const std::string& type = "application/json") const {
    http::Client client(serving->url());
    return client.send(
        {.method = method,
         .target = target,
         .headers = {{"Authorization", "Bearer " + token},
                     {"Content-Type", type},
                     {"Accept", target == "/predictions" ? "application/x-hdf5" : "application/json"},
                     {"Idempotency-Key", key}},
         .body = body});
  }
  [[nodiscard]] static std::string inputs() {
    Json inputs;
    for (std::size_t i = 0; i < 4; ++i)
      inputs["flow_" + std::to_string(i) + " [kg/s]"] = test::sample_case()[i];
    return inputs.dump();
  }
};

/// Gives a field in a file of predictions one value everywhere.
void flatten(const std::filesystem::path& file, const std::string& field) {
  const auto hdf = io::Hdf5File::open(file, io::Hdf5File::Access::edit);
  const auto dataset = hdf.group("elrom/fields").dataset(field);
  auto values = dataset.read<float>();
  for (auto& value : values) value = values.front();
  dataset.write(std::span<const float>(values));
}

TEST(ElromServe, KeepsWhatItAcknowledgedWhenItIsKilled) {
  Started started;
  const auto body = R"({"name": "a", "inputs": )" + Started::inputs() + "}";
  const auto made = started.call("POST", "/scenarios", body);

  started.serving->end(SIGKILL);
  started.serving->begin();
  const auto again = started.call("POST", "/scenarios", body);

  EXPECT_EQ(made.status, 201);
  EXPECT_EQ(again.body, made.body);
  EXPECT_EQ(*again.header("Idempotent-Replayed"), "true");
}

TEST(ElromServe, StopsWithoutLosingTheRequestInWork) {
  Started started;
  const std::string head =
      "POST /scenarios HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nIdempotency-Key: k\r\n"
      "Authorization: Bearer " +
      started.token + "\r\nContent-Length: ";
  const auto body = R"({"name": "a", "inputs": )" + Started::inputs() + "}";
  const auto port = static_cast<unsigned short>(
      std::stoi(started.serving->url().substr(started.serving->url().rfind(':') + 1)));
  test::RawConnection connection(port);
  connection.send(head + std::to_string(body.size()) + "\r\n\r\n" + body.substr(0, 10));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));

  auto ended = std::async(std::launch::async, [&] { return started.serving->end(SIGTERM); });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  connection.send(body.substr(10));

  EXPECT_THAT(connection.read_all(5), HasSubstr("HTTP/1.1 201 Created"));
  EXPECT_EQ(ended.get(), 0);
}

TEST(ElromServe, AnUploadThatItsDeathCutLeavesNothingAndIsSentAgain) {
  Started started;
  const auto file = started.call("POST", "/predictions", R"({"inputs": )" + Started::inputs() + "}").body;
  const auto place = "/fields/" + base::sha256(std::as_bytes(std::span(file)));
  const auto port = static_cast<unsigned short>(
      std::stoi(started.serving->url().substr(started.serving->url().rfind(':') + 1)));
  const test::RawConnection connection(port);
  connection.send("PUT " + place +
                  " HTTP/1.1\r\nHost: x\r\nContent-Type: application/x-hdf5\r\nAuthorization: Bearer " +
                  started.token + "\r\nContent-Length: " + std::to_string(file.size()) + "\r\n\r\n" +
                  file.substr(0, file.size() / 2));

  started.serving->end(SIGKILL);
  started.serving->begin();

  EXPECT_EQ(started.call("GET", place).status, 404);
  EXPECT_EQ(started.call("PUT", place, file, "k", "application/x-hdf5").status, 201);
  EXPECT_EQ(started.call("GET", place).body, file);
}

TEST(ElromServe, LooksAtUploadsInAProcessOfItsOwn) {
  Started started;
  const auto file = started.call("POST", "/predictions", R"({"inputs": )" + Started::inputs() + "}").body;
  const auto digest = base::sha256(std::as_bytes(std::span(file)));
  auto broken = file;
  for (std::size_t i = 600; i < broken.size(); i += 97) broken[i] = static_cast<char>(broken[i] ^ 0x55);

  const auto kept = started.call("PUT", "/fields/" + digest, file, "k", "application/x-hdf5");
  const auto refused = started.call("PUT", "/fields/" + base::sha256(std::as_bytes(std::span(broken))),
                                    broken, "k", "application/x-hdf5");

  EXPECT_EQ(kept.status, 201) << kept.body;
  EXPECT_EQ(started.call("GET", "/fields/" + digest).body, file);
  EXPECT_EQ(refused.status, 422) << refused.body;
  EXPECT_EQ(started.call("GET", "/healthz").status, 200);
}

TEST(ElromServe, ItsChildrenHoldNeitherItsPortNorItsCallers) {
  Started started;
  const std::string mark = "/proc/" + std::to_string(started.serving->process()) + "/fd";
  const http::Response answer = started.call("GET", "/healthz");
  int n_sockets = 0;
  for (const auto& entry : std::filesystem::directory_iterator(mark)) {
    std::error_code gone;
    const auto what = std::filesystem::read_symlink(entry.path(), gone).string();
    if (!what.starts_with("socket:")) continue;
    std::ifstream info(std::filesystem::path(mark + "info") / entry.path().filename());
    const std::string text(std::istreambuf_iterator<char>(info), {});
    const auto at = text.find("flags:\t");
    constexpr unsigned long closes_on_exec = 02000000;
    EXPECT_NE(std::stoul(text.substr(at + 7), nullptr, 8) & closes_on_exec, 0U) << text;
    ++n_sockets;
  }

  EXPECT_EQ(answer.status, 200);
  EXPECT_GT(n_sockets, 0);
}

TEST(ElromServe, RefusesFieldsThatPhysicsForbids) {
  Started started;
  const auto file = started.call("POST", "/predictions", R"({"inputs": )" + Started::inputs() + "}").body;
  test::write_bytes(started.folder / "flat.hdf", file);
  flatten(started.folder / "flat.hdf", "gas_velocity_z");
  const auto flat = test::read_bytes(started.folder / "flat.hdf");

  const auto refused = started.call("PUT", "/fields/" + base::sha256(std::as_bytes(std::span(flat))), flat,
                                    "k", "application/x-hdf5");

  EXPECT_EQ(refused.status, 422) << refused.body;
  EXPECT_THAT(refused.body, HasSubstr("gas_velocity_z"));
  EXPECT_THAT(refused.body, HasSubstr("/quarantine/1"));
}

TEST(ElromServe, AFullDiskLosesNothingThatWasAcknowledged) {
  Started started;
  if (!started.disk.mounted()) GTEST_SKIP() << "no small disk may be mounted: " << started.disk.reason();
  const auto add = [&](int i) {
    const auto name = std::to_string(i);
    return started
        .call("POST", "/scenarios", R"({"name": ")" + name + R"(", "inputs": )" + Started::inputs() + "}",
              name)
        .status;
  };
  std::vector<int> acknowledged;
  int n_refused = 0;
  {
    const test::Ballast ballast(started.folder / "disk/ballast");
    for (int i = 0; n_refused < 3 && i < 100000; ++i) {
      const int status = add(i);
      if (status == 201)
        acknowledged.push_back(i);
      else
        n_refused += status == 503;
    }
  }
  EXPECT_EQ(n_refused, 3) << "the disk was never full";

  EXPECT_EQ(add(100001), 201) << "there is room again";
  started.serving->end(SIGKILL);
  started.serving->begin();
  for (const int i : acknowledged) EXPECT_EQ(add(i), 201) << "told again: " << i;
  const auto list = Json::parse(started.call("GET", "/scenarios?limit=1000").body)["items"];
  EXPECT_EQ(list.size(), acknowledged.size() + 1);
}

TEST(ElromServe, BacksUpWhatItServesAndRestoresIt) {
  Started started;
  const auto body = R"({"name": "a", "inputs": )" + Started::inputs() + "}";
  started.call("POST", "/scenarios", body);
  const auto backup = (started.folder / "backup").string(), again = (started.folder / "again").string();

  const auto made = outcome_of(program + " --data " + started.data + " --backup " + backup);
  const auto restored = outcome_of(program + " --data " + again + " --restore " + backup);

  EXPECT_EQ(made.status, 0) << made.text;
  EXPECT_THAT(made.text, HasSubstr("backed up: 4 rows, 0 files"));
  EXPECT_EQ(restored.status, 0) << restored.text;
  started.serving = std::make_unique<Serving>(program, std::vector<std::string>{"--data", again, "--quiet"});
  EXPECT_EQ(*started.call("POST", "/scenarios", body).header("Idempotent-Replayed"), "true");
  EXPECT_EQ(outcome_of(program + " --data " + again + " --restore " + backup + " 2>&1").status, 2);
}

TEST(ElromServe, TakesUpANewModelByItself) {
  Started started;
  const auto before = started.call("GET", "/model").body;

  test::sample_bundle({}, 2).write(started.folder / "model.elrom");
  auto after = before;
  for (int i = 0; i < 50 && after == before; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    after = started.call("GET", "/model").body;
  }

  EXPECT_NE(after, before);
}

TEST(ElromServe, ABrokenNewModelDoesNotReplaceTheOldOne) {
  Started started;
  const auto before = started.call("GET", "/model").body;

  test::write_bytes(started.folder / "next", "no bundle");
  std::filesystem::rename(started.folder / "next", started.folder / "model.elrom");
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));

  EXPECT_EQ(started.call("GET", "/model").body, before);
}

TEST(ElromServe, WrongCommandLinesAreOneLine) {
  const test::TemporaryFolder folder;
  const auto data = " --data " + (folder / "data").string();
  const auto fails = [&](const std::string& arguments, int status, const std::string& words) {
    const auto ended = outcome_of(program + arguments + " 2>&1");
    EXPECT_EQ(ended.status, status) << ended.text;
    EXPECT_THAT(ended.text, HasSubstr(words));
    EXPECT_EQ(std::ranges::count(ended.text, '\n'), 1) << ended.text;
  };

  fails("", 2, "--data is missing");
  fails(data + " --port 70000", 2, "--port");
  fails(data + " --database mysql://x", 2, "unknown database");
  fails(data + " --make-token x", 2, "NAME=ROLE");
  fails(data + " --make-token x=king", 2, "unknown role");
  fails(data + " --anonymous king", 2, "unknown role");
  fails(data + " --port 0 --address nowhere", 3, "no address to listen at");
  fails(data + " --port 0 --certificate /no.pem --key /no.key", 3, "cannot use the certificate");
  fails(" --judge-fields /nothing.hdf", 3, "/nothing.hdf");
}

}  // namespace
}  // namespace elrom::serve
