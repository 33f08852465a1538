#pragma once
// The seam between the study and other processes that take units of its training (elrom::mpi): crews of a
// screening here, trials and builds through Trainer.

#include <functional>
#include <memory>
#include <vector>

#include "elrom/networks/screening.hpp"
#include "elrom/networks/trainer.hpp"

namespace elrom::networks {

class Workers {
 public:
  virtual ~Workers() = default;
  /// Units that run side by side, one of them in this process.
  [[nodiscard]] virtual int n_units() const = 0;
  /// Gives crews of this screening to whoever is free; the same bits wherever they are trained. The arguments
  /// must outlive what comes back. Thread rule: any thread, and so may what comes back be called.
  [[nodiscard]] virtual CrewTrainer crew_trainer(const ScreeningData& data, const ScreenSettings& settings,
                                                 base::Seed seed) const = 0;
  /// Gives each training to whoever is free; `here` does this process's share.
  [[nodiscard]] virtual std::shared_ptr<const Trainer> trainer(std::shared_ptr<const Trainer> here) const = 0;
};

}  // namespace elrom::networks
