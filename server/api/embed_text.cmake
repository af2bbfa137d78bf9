# SPDX-License-Identifier: Apache-2.0
# INPUT, a text, becomes OUTPUT, a header with openapi_text. Run by the build.
file(READ ${INPUT} text)
file(WRITE ${OUTPUT}
"#pragma once

#include <string_view>

namespace aeolis::server {

/// server/api/openapi.yaml, as it stood when this was built.
inline constexpr std::string_view openapi_text = R\"openapi(${text})openapi\";

} // namespace aeolis::server
")
