#include "elrom/serve/resident_model.hpp"

#include <algorithm>

#include "cuts.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::serve {
namespace {

bool has_all_intervals(const model::BundleReader& bundle) {
  return std::ranges::all_of(bundle.info().fields, [&](const field::FieldInfo& info) {
    const auto uncertainty = bundle.uncertainty(info.name);
    if (!uncertainty) return false;
    try {
      (void)uncertainty->quantile(OpenModel::level);
      return true;
    } catch (const UsageError&) {  // too few cases to promise it
      return false;
    }
  });
}

}  // namespace

OpenModel::OpenModel(const std::filesystem::path& bundle)
    : bundle_(bundle),
      guard_(bundle_.guard()),
      file_(bundle),
      has_intervals_(has_all_intervals(bundle_)),
      plain_(fields().size()),
      with_intervals_(has_intervals_ ? fields().size() : 0) {
  base::parallel_for(fields().size(), base::available_threads(), [&](std::size_t i, int) {
    plain_[i] = std::make_unique<model::Predictor>(bundle, model::Selection{.fields = {fields()[i].name}});
    if (has_intervals_)
      with_intervals_[i] = std::make_unique<model::Predictor>(
          bundle, model::Selection{.fields = {fields()[i].name}, .interval_level = level});
  });
}

OpenModel::~OpenModel() = default;

const Cuts& OpenModel::cuts() const {
  std::call_once(cuts_once_, [&] { cuts_ = std::make_unique<const Cuts>(bundle_.mesh()); });
  return *cuts_;
}

OpenModel::Scratch OpenModel::take_scratch() const {
  const std::scoped_lock lock(mutex_);
  if (scratch_.empty()) return std::make_unique<model::Predictor::Scratch>();
  auto scratch = std::move(scratch_.back());
  scratch_.pop_back();
  return scratch;
}

OpenModel::Values OpenModel::predict(std::span<const double> inputs, std::span<const std::size_t> i_fields,
                                     bool intervals, int n_threads) const {
  const bool widths = intervals && has_intervals_;
  Values result;
  result.values.resize(i_fields.size() * n_cells());
  if (widths) result.half_width.resize(result.values.size());
  base::parallel_for(i_fields.size(), n_threads, [&](std::size_t i, int) {
    auto scratch = take_scratch();
    const auto& predictor = widths ? *with_intervals_[i_fields[i]] : *plain_[i_fields[i]];
    const auto part = [&](base::LargeArray<float>& all) {
      return std::span(all).subspan(i * n_cells(), n_cells());
    };
    predictor.predict(inputs, part(result.values), widths ? part(result.half_width) : std::span<float>(),
                      *scratch);
    const std::scoped_lock lock(mutex_);
    scratch_.push_back(std::move(scratch));
  });
  return result;
}

ResidentModel::ResidentModel(std::filesystem::path where) : where_(std::move(where)) {}

std::shared_ptr<const OpenModel> ResidentModel::now() const {
  const std::scoped_lock lock(mutex_);
  return model_;
}

/// By the name behind all links: a version's file never changes, its link does.
std::optional<ResidentModel::Identity> ResidentModel::found() const {
  std::error_code fault;
  const auto named = std::filesystem::is_directory(where_, fault) ? where_ / "model.elrom" : where_;
  const auto file = std::filesystem::canonical(named, fault);
  if (fault) return std::nullopt;
  Identity identity{file, std::filesystem::file_size(file, fault), {}};
  if (!fault) identity.changed = std::filesystem::last_write_time(file, fault);
  if (fault) return std::nullopt;
  return identity;
}

bool ResidentModel::look() {
  const std::scoped_lock one(looking_);
  const auto there = found();
  if (!there || there == looked_at_) return false;
  looked_at_ = there;  // one that cannot be used is told of once
  auto model = std::make_shared<const OpenModel>(there->file);
  const std::scoped_lock lock(mutex_);
  model_ = std::move(model);
  return true;
}

}  // namespace elrom::serve
