# SPDX-License-Identifier: Apache-2.0
# INPUTS, files separated by commas, become OUTPUT, a header with embedded_texts. Run by the build.
string(REPLACE "," ";" inputs ${INPUTS})
set(rows "")
foreach(input ${inputs})
    file(READ ${input} text)
    cmake_path(GET input FILENAME name)
    string(APPEND rows "    EmbeddedText{\"${name}\", R\"embedded(${text})embedded\"},\n")
endforeach()
list(LENGTH inputs count)
file(WRITE ${OUTPUT}
"#pragma once

#include <array>
#include <string_view>

namespace aeolis::server {

/// A file that the server gives, as it stood when this was built.
struct EmbeddedText {
    std::string_view name, text;
};
inline constexpr std::array<EmbeddedText, ${count}> embedded_texts{
${rows}};

} // namespace aeolis::server
")
