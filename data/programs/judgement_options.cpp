#include "judgement_options.hpp"

#include "elrom/base/comma_list.hpp"
#include "elrom/base/text.hpp"

namespace elrom::programs {

void add_accept(cli::App& command, JudgementOptions& options) {
  base::comma_list(command.add_option("--accept", options.accepted,
                                      "Findings that are only told, separated by commas: " +
                                          base::join(ingest::finding_kinds(), ", ")))
      ->type_name("CHECK,...");
}

void add_judgement(cli::App& command, JudgementOptions& options) {
  command
      .add_option(
          "--on-suspicious", options.policy,
          R"(A case that is wrong or suspicious, in itself or beside the others (see 'elrom-data check'):
refuse everything, drop that case, or keep it with a warning)")
      ->capture_default_str()
      ->check(cli::IsMember({"refuse", "drop", "keep"}));
  add_accept(command, options);
}

}  // namespace elrom::programs
