#pragma once
// What strangers send to elrom-serve, as a fuzzer throws it: paths, JSON, whole requests behind and before
// the parser, files of fields.

#include <string>
#include <vector>

#include "fuzz_targets.hpp"

namespace elrom::faults {

/// http_target, json_body, service_request (a request that was parsed, answered with an admin's rights),
/// http_wire (any bytes on a connection), scenario (its judgement and the problem document), fields_upload (a
/// file of any bytes, judged by its numbers and by physics). Beside crashes, an answer
/// that blames the server, a path that leads out of its folder and a server that answers nobody afterwards
/// are findings.
[[nodiscard]] std::vector<FuzzTarget> service_targets();
/// Empty: another's target.
[[nodiscard]] std::vector<std::string> service_seeds(const std::string& target);

}  // namespace elrom::faults
