// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/text_file.hpp"

#include <fmt/format.h>
#include <fstream>

namespace aeolis::server {

Result<std::string> bounded_text(const std::filesystem::path& file, std::size_t octets_max, std::string_view what) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        return Error{fmt::format("{}: is a directory, not a {}", file.string(), what)};
    std::ifstream stream{file, std::ios::binary};
    if (!stream) return Error{file.string() + ": cannot be opened"};
    std::string text(octets_max + 1, '\0');  // one octet more shows that there are too many
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > octets_max)
        return Error{fmt::format("{}: larger than {} octets, which are all that a {} may have", file.string(),
                                 octets_max, what)};
    return text;
}

}  // namespace aeolis::server
