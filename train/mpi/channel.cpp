#include "channel.hpp"

#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "elrom/base/error.hpp"

namespace elrom::mpi {
namespace {

using Json = nlohmann::json;

constexpr int tag = 1;
constexpr std::size_t largest_piece = std::size_t{1} << 30;  // MPI counts in int

std::string head_of(const io::TensorFile& message) {
  Json tensors = Json::array();
  for (const auto& [name, tensor] : message.tensors())
    tensors.push_back({name, static_cast<int>(tensor.type()), tensor.shape()});
  // The text of an error may name a file whose name is not UTF-8.
  return Json{{"texts", message.texts()}, {"tensors", tensors}}.dump(-1, ' ', false,
                                                                     Json::error_handler_t::replace);
}

}  // namespace

Channel::Channel() {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
  if (provided < MPI_THREAD_SERIALIZED) {
    MPI_Finalize();
    throw SystemError({.what = "this MPI cannot be called from threads",
                       .expected = "MPI_THREAD_SERIALIZED or more",
                       .advice = "use another MPI, or one process"});
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

void Patience::wait() {
  std::this_thread::sleep_for(pause_);
  pause_ = std::min(pause_ * 2, std::chrono::microseconds(1000));
}

Channel::~Channel() { MPI_Finalize(); }

template <class Start>
void Channel::transfer(const Start& start) {
  MPI_Request request{};
  {
    const std::scoped_lock lock(mutex_);
    start(&request);
  }
  Patience patience;
  for (;;) {
    int done = 0;
    {
      const std::scoped_lock lock(mutex_);
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    }
    if (done != 0) return;
    patience.wait();
  }
}

void Channel::send_bytes(int to, std::span<const std::byte> bytes) {
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(largest_piece, bytes.size()))) {
    const auto n = static_cast<int>(std::min(largest_piece, bytes.size()));
    transfer([&](MPI_Request* request) {
      MPI_Isend(bytes.data(), n, MPI_BYTE, to, tag, MPI_COMM_WORLD, request);
    });
  }
}

void Channel::receive_bytes(int from, std::span<std::byte> bytes) {
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(largest_piece, bytes.size()))) {
    const auto n = static_cast<int>(std::min(largest_piece, bytes.size()));
    transfer([&](MPI_Request* request) {
      MPI_Irecv(bytes.data(), n, MPI_BYTE, from, tag, MPI_COMM_WORLD, request);
    });
  }
}

void Channel::abort(const std::string& why) noexcept {
  std::fprintf(stderr, "error: rank %d: %s; the job ends, run it again to go on\n", rank_, why.c_str());
  const std::scoped_lock lock(mutex_);
  MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitStatus::internal));
  std::abort();
}

void Channel::send(int to, const io::TensorFile& message) {
  try {
    send_whole(to, message);
  } catch (const std::exception& error) {
    abort(std::string("a message to rank ") + std::to_string(to) + " broke off: " + error.what());
  }
}

io::TensorFile Channel::receive(int from) {
  try {
    return receive_whole(from);
  } catch (const std::exception& error) {
    abort(std::string("a message from rank ") + std::to_string(from) + " broke off: " + error.what());
  }
}

void Channel::send_whole(int to, const io::TensorFile& message) {
  const auto head = head_of(message);
  const std::uint64_t length = head.size();
  send_bytes(to, std::as_bytes(std::span(&length, 1)));
  send_bytes(to, std::as_bytes(std::span(head)));
  for (const auto& [name, tensor] : message.tensors()) send_bytes(to, tensor.bytes());
}

std::optional<io::TensorFile> Channel::poll(int from) {
  int there = 0;
  {
    const std::scoped_lock lock(mutex_);
    MPI_Iprobe(from, tag, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE);
  }
  if (there == 0) return std::nullopt;
  return receive(from);
}

io::TensorFile Channel::receive_whole(int from) {
  std::uint64_t length = 0;
  receive_bytes(from, std::as_writable_bytes(std::span(&length, 1)));
  std::string text(length, '\0');
  receive_bytes(from, std::as_writable_bytes(std::span(text)));
  const auto head = Json::parse(text);
  io::TensorFile message;
  for (const auto& [key, value] : head["texts"].items()) message.set_text(key, value);
  for (const auto& entry : head["tensors"]) {
    const auto type = static_cast<io::DType>(entry[1].get<int>());
    const auto shape = entry[2].get<std::vector<std::size_t>>();
    std::size_t n = io::size_of(type);
    for (const auto size : shape) n *= size;
    const auto bytes = std::make_shared<std::vector<std::byte>>(n);
    receive_bytes(from, *bytes);
    message.set(entry[0], io::Tensor(type, shape, bytes, bytes->data()));
  }
  return message;
}

}  // namespace elrom::mpi
