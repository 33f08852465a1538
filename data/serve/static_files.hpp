#pragma once
// The files of a page: one folder, nothing outside it, and a policy that lets a page load nothing from
// elsewhere. Who has a file already gets no more than word of it (ETag).
//
// Thread rule: pure functions.

#include <filesystem>
#include <optional>

#include "elrom/http/message.hpp"

namespace elrom::serve {

/// Nothing: there is no such file in the folder. "/" is index.html.
/// @param target of the request
[[nodiscard]] std::optional<http::Response> static_file(const std::filesystem::path& folder,
                                                        const http::Target& target,
                                                        const http::Request& request);

}  // namespace elrom::serve
