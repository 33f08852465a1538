#pragma once
// Text files of spreadsheets, whatever they were saved as.

#include <string>

namespace elrom::io {

/// As UTF-8 without a byte order mark: from UTF-8, from UTF-16 with a byte order mark (Excel's "Unicode
/// text"), or, where the bytes are no UTF-8, from Latin-1. What holds zero bytes stays as it is.
[[nodiscard]] std::string in_utf8(std::string bytes);

}  // namespace elrom::io
