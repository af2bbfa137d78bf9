// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aeolis::server {

inline constexpr const char* version = "0.1.0";  ///< of program and API; 1.0.0 when the routes are promised

}  // namespace aeolis::server
