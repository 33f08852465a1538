#include "elrom/particle/network_regressor.hpp"

#include <array>

#include "elrom/base/error.hpp"

namespace elrom::particle {
namespace {

void expect_scaler(const math::Standardiser& scaler, std::size_t size, const char* what) {
  const bool fits = static_cast<std::size_t>(scaler.size()) == size && scaler.mean().allFinite() &&
                    scaler.scale().allFinite() && (scaler.scale().array() > 0).all();
  if (!fits)
    throw InputError(
        Problem{.what = "broken network surrogate", .found = std::string("wrong scales of its ") + what});
}

void write_scaler(io::TensorFile& file, const std::string& name, const math::Standardiser& scaler) {
  MatrixD rows(2, scaler.size());
  rows.row(0) = scaler.mean().transpose();
  rows.row(1) = scaler.scale().transpose();
  file.set(name, io::Tensor::copy(rows));
}

math::Standardiser read_scaler(const io::TensorFile& file, const std::string& name) {
  const auto rows = file.tensor(name, std::array<std::size_t, 2>{2, io::any_size}).matrix64();
  return {rows.row(0).transpose(), rows.row(1).transpose()};
}

}  // namespace

NetworkRegressor::NetworkRegressor(math::Standardiser inputs, math::Standardiser outputs,
                                   model::Network network)
    : inputs_(std::move(inputs)), outputs_(std::move(outputs)), network_(std::move(network)) {
  expect_scaler(inputs_, network_.n_inputs(), "inputs");
  expect_scaler(outputs_, network_.n_outputs(), "outputs");
}

void NetworkRegressor::evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const {
  const MatrixF x = ((inputs.rowwise() - inputs_.mean().transpose().array()).rowwise() /
                     inputs_.scale().transpose().array())
                        .matrix()
                        .cast<float>();
  MatrixF y(inputs.rows(), static_cast<Eigen::Index>(n_outputs()));
  model::Workspace workspace;
  network_.forward(x, y, workspace);
  outputs = (y.cast<double>().array().rowwise() * outputs_.scale().transpose().array()).rowwise() +
            outputs_.mean().transpose().array();
}

void NetworkRegressor::write(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix + "/kind", kind());
  write_scaler(file, prefix + "/inputs", inputs_);
  write_scaler(file, prefix + "/outputs", outputs_);
  network_.save(file, prefix + "/network");
}

std::unique_ptr<NetworkRegressor> NetworkRegressor::read(const io::TensorFile& file,
                                                         const std::string& prefix) {
  return std::make_unique<NetworkRegressor>(read_scaler(file, prefix + "/inputs"),
                                            read_scaler(file, prefix + "/outputs"),
                                            model::Network::load(file, prefix + "/network"));
}

}  // namespace elrom::particle
