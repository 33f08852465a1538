// Readers while a bundle is replaced: each sees the old one or
// the new one, whole. For the thread sanitizer too.

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "elrom/model/predictor.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::model {
namespace {

constexpr int n_readers = 64, n_replacements = 40;

std::vector<float> prediction_of(const Predictor& predictor) {
  std::vector<float> values(predictor.size());
  Predictor::Scratch scratch;
  predictor.predict(test::sample_case(), values, {}, scratch);
  return values;
}

struct Version {
  Bundle bundle;
  std::string digest;
  std::vector<float> values;

  Version(std::uint64_t seed, const std::filesystem::path& path) : bundle(test::sample_bundle({}, seed)) {
    bundle.write(path);
    const Predictor predictor(path);
    digest = predictor.bundle().digest();
    values = prediction_of(predictor);
  }
};

TEST(ReplacedBundle, SixtyFourReadersSeeTheOldOneOrTheNewOne) {
  const test::TemporaryFolder folder;
  const auto path = folder / "model.elrom";
  const Version even(2, path), odd(1, path);
  ASSERT_NE(even.values, odd.values);
  const Predictor shared(path);  // opened before, used by all readers beside their own
  std::atomic<int> n_wrong = 0, n_even = 0, n_odd = 0;
  std::atomic<bool> replaced = false;

  {
    std::vector<std::jthread> readers;
    for (int r = 0; r < n_readers; ++r) {
      readers.emplace_back([&] {
        do {
          const Predictor own(path);
          const bool is_even = own.bundle().digest() == even.digest;
          (is_even ? n_even : n_odd) += 1;
          if (prediction_of(own) != (is_even ? even : odd).values || prediction_of(shared) != odd.values)
            ++n_wrong;
        } while (!replaced);
      });
    }
    for (int i = 0; i < n_replacements; ++i) (i % 2 == 0 ? even : odd).bundle.write(path);
    replaced = true;
  }

  EXPECT_EQ(n_wrong, 0);
  EXPECT_GT(n_even, 0);
  EXPECT_GT(n_odd, 0);
}

}  // namespace
}  // namespace elrom::model
