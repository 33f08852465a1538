#include "stream.hpp"

namespace elrom::http {

void Stream::async_handshake(asio::ssl::stream_base::handshake_type side, Done done) {
  secure_->async_handshake(side, std::move(done));
}
void Stream::async_shutdown(Done done) { secure_->async_shutdown(std::move(done)); }

void Stream::read_some(const Some<asio::mutable_buffer>& buffers, SomeDone done) {
  if (secure_)
    secure_->async_read_some(buffers, std::move(done));
  else
    plain_->async_read_some(buffers, std::move(done));
}
void Stream::write_some(const Some<asio::const_buffer>& buffers, SomeDone done) {
  if (secure_)
    secure_->async_write_some(buffers, std::move(done));
  else
    plain_->async_write_some(buffers, std::move(done));
}

}  // namespace elrom::http
